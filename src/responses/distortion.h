// SPDX-License-Identifier: MIT
/// \file
/// The keys of distortion, as an objective and as a constraint (docs/formulation.md 5). With `after_release`
/// it measures the displacement u + v of the part cut from its supports (4.3).
#pragma once

#include "fabseq/responses/response_type.h"

#include <optional>
#include <string>
#include <vector>

namespace fabseq {

/// What is measured, in the order of the words of the key.
enum class Measure { displacement, flatness, layerwise, shape, angle };

/// The settings of a distortion term.
struct DistortionSettings {
  Measure measure = Measure::displacement;
  std::string nodes;  ///< name of a node set
  std::string to;     ///< name of the other node set of angle
  int axis = -1;      ///< of flatness; -1: not given
  bool mean = false;
  std::optional<double> norm;  ///< power p of displacement; none: a sum or mean of squares
  bool after_release = false;
  std::vector<std::string> fit = {"translation", "rotation"};  ///< of shape
  Aggregate aggregate = Aggregate::nominal;
  std::optional<bool> least_squares;  ///< none: with scaling `current`, while the squares hold most of it

  TermFacts facts() const;
  /// Checks relations of the keys. Throws InputError.
  void check(const TermPlace& place) const;
  /// Whether the best fit of shape may move this, such as "rotation".
  bool fits(const std::string& motion) const;
  /// Whether the optimizer may have the measure as a sum of squares. "auto" leaves terms with the published
  /// scaling as they were published.
  bool offers_squares(TermScaling scaling) const {
    return least_squares.value_or(scaling == TermScaling::current);
  }

 private:
  void check_node_sets(const TermPlace& place) const;
  std::string with_measure() const;
  std::string aggregate_name() const;
};

/// The keys of a distortion term in a section, "objective" or "constraints".
Section<DistortionSettings> distortion_keys(const std::string& section);

}  // namespace fabseq
