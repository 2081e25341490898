// SPDX-License-Identifier: MIT
#include "fabseq/base/error.h"
#include "fabseq/responses/continuity.h"
#include "fabseq/responses/deposition_speed.h"
#include "fabseq/responses/distortion.h"
#include "fabseq/responses/distortion_functionals.h"
#include "fabseq/responses/last_layer.h"
#include "fabseq/responses/layer_thickness.h"
#include "fabseq/responses/layer_uniformity.h"
#include "fabseq/responses/minimum_layer_volume.h"
#include "fabseq/responses/response.h"
#include "fabseq/responses/segmentation_alignment.h"
#include "fabseq/responses/subpart_volume.h"

#include <functional>

namespace fabseq {

namespace {

template <class Term, int Dim>
using Maker = std::function<std::unique_ptr<Response<Dim>>(const Term&, const ResponseContext<Dim>&)>;

/// Objective terms by type and, where a type has several, its form or measure.
template <int Dim>
const std::map<std::string, Maker<ObjectiveTerm, Dim>>& objectives() {
  using Term = ObjectiveTerm;
  using Context = ResponseContext<Dim>;
  static const std::map<std::string, Maker<Term, Dim>> makers = {
      {"distortion displacement",
       [](const Term& t, const Context& c) {
         return make_displacement_distortion(c.part, c.node_sets.at(t.nodes), t.mean, t.after_release);
       }},
      {"distortion flatness",
       [](const Term& t, const Context& c) {
         return make_flatness_distortion(c.part, c.node_sets.at(t.nodes), t.axis, t.after_release);
       }},
      {"distortion layerwise", [](const Term&, const Context&) { return make_layerwise_distortion<Dim>(); }},
      {"layer_uniformity sum_of_squares",
       [](const Term&, const Context& c) { return make_sum_of_squares_uniformity(c); }},
      {"layer_uniformity variance",
       [](const Term&, const Context& c) { return make_variance_uniformity(c); }},
      {"segmentation_alignment ",
       [](const Term& t, const Context& c) { return make_segmentation_alignment(c, t.band); }},
  };
  return makers;
}

template <int Dim>
const std::map<std::string, Maker<ConstraintTerm, Dim>>& constraints() {
  using Term = ConstraintTerm;
  using Context = ResponseContext<Dim>;
  static const std::map<std::string, Maker<Term, Dim>> makers = {
      {"layer_thickness",
       [](const Term& t, const Context& c) {
         return make_layer_thickness(c, t.target, t.tolerance, t.least_volume);
       }},
      {"deposition_speed", [](const Term& t, const Context& c) { return make_deposition_speed(c, t.slack); }},
      {"continuity", [](const Term& t, const Context& c) { return make_continuity(c, t.limit); }},
      {"minimum_layer_volume",
       [](const Term& t, const Context& c) { return make_minimum_layer_volume(c, t.fraction); }},
      {"last_layer", [](const Term& t, const Context& c) { return make_last_layer(c, t.least_volume); }},
      {"subpart_volume", [](const Term& t, const Context& c) { return make_subpart_volume(c, t.tolerance); }},
  };
  return makers;
}

template <class Makers>
const typename Makers::mapped_type& look_up(const Makers& makers, const std::string& name) {
  const auto found = makers.find(name);
  if (found == makers.end()) throw InputError("no response is called \"" + name + "\"");
  return found->second;
}

}  // namespace

template <int Dim>
std::unique_ptr<Response<Dim>> make_objective(const ObjectiveTerm& term,
                                              const ResponseContext<Dim>& context) {
  return look_up(objectives<Dim>(), term.type + " " + term.measure + term.form)(term, context);
}

template <int Dim>
std::unique_ptr<Response<Dim>> make_constraint(const ConstraintTerm& term,
                                               const ResponseContext<Dim>& context) {
  return look_up(constraints<Dim>(), term.type)(term, context);
}

template <int Dim>
std::unique_ptr<DistortionFunctionals<Dim>> make_functionals(const ObjectiveTerm& term,
                                                             const ResponseContext<Dim>& context) {
  if (term.measure == "displacement")
    return make_displacement_functionals(context.part, context.node_sets.at(term.nodes), term.mean,
                                         term.after_release);
  if (term.measure == "flatness")
    return make_flatness_functionals(context.part, context.node_sets.at(term.nodes), term.axis,
                                     term.after_release);
  return nullptr;
}

#define FABSEQ_INSTANTIATE(Dim)                                                                            \
  template std::unique_ptr<DistortionFunctionals<Dim>> make_functionals<Dim>(const ObjectiveTerm&,         \
                                                                             const ResponseContext<Dim>&); \
  template std::unique_ptr<Response<Dim>> make_objective<Dim>(const ObjectiveTerm&,                        \
                                                              const ResponseContext<Dim>&);                \
  template std::unique_ptr<Response<Dim>> make_constraint<Dim>(const ConstraintTerm&,                      \
                                                               const ResponseContext<Dim>&);
FABSEQ_INSTANTIATE(2)
FABSEQ_INSTANTIATE(3)
#undef FABSEQ_INSTANTIATE

}  // namespace fabseq
