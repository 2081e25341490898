// SPDX-License-Identifier: MIT
/// \file
/// Responses without a config.
#pragma once

#include "fabseq/responses/response_type.h"

#include <memory>
#include <string>

namespace fabseq::test {

/// The response of a term, as the config has it; keys left out have their defaults.
template <int Dim>
std::unique_ptr<Response<Dim>> make_response(TermList list, const std::string& term,
                                             const ResponseContext<Dim>& context) {
  const Term made = make_term(list, parse_json(term, "term"));
  return made.type->make(made, context);
}

}  // namespace fabseq::test
