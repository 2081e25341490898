// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/layers/layer_settings.h"
#include "fabseq/layers/layer_variables.h"
#include "fabseq/layers/layers.h"
#include "fabseq/part/part.h"

#include <memory>
#include <span>
#include <string>
#include <utility>

namespace fabseq {

/// What is fixed for all designs of a part.
struct LayerTraits {
  std::string kind;  ///< for messages: curved, multi-planar
  std::string key;   ///< of the config, by which the layers become more or fewer
  int count = 0;     ///< number of layers
  bool count_is_estimate = false;
  double first_beta = 0.0;  ///< sharpness at the start of the continuation
  double last_beta = 0.0;   ///< the most it grows to
  LayerVariables variables = {};
  int sub_parts = 0;           ///< 0 for layers without sub-parts
  bool time_is_fixed = false;  ///< whether the sequence's field is kept from the optimizer
};

/// A kind of layers, curved or multi-planar, which makes those of a design (docs/formulation.md 3).
template <int Dim>
class LayerModel {
 public:
  virtual ~LayerModel() = default;
  LayerModel(const LayerModel&) = delete;
  LayerModel& operator=(const LayerModel&) = delete;

  const LayerTraits& traits() const { return traits_; }
  int count() const { return traits_.count; }
  const LayerVariables& variables() const { return traits_.variables; }

  /// Layers for values of the variables; without values, those the settings start from. `beta`: sharpness of
  /// kinds whose sharpness grows. `negligible`: layers to leave out, by kinds whose number is not given.
  virtual std::unique_ptr<Layers> make(std::span<const double> variables, double beta, bool binary,
                                       const NegligibleLayers& negligible) const = 0;
  /// Number of planar layers, as thick as these, that a part of this height is built in.
  virtual int planar_count(double height) const = 0;

 protected:
  explicit LayerModel(LayerTraits traits) : traits_(std::move(traits)) {}

 private:
  LayerTraits traits_;
};

/// The layers that the settings ask for. Collective; throws InputError if there are too many. The part must
/// outlive the model.
template <int Dim>
std::unique_ptr<const LayerModel<Dim>> make_layer_model(const LayerSettings& layers,
                                                        const ProjectionSettings& projection,
                                                        const Part<Dim>& part);
/// So many layers between isosurfaces at uniform times.
template <int Dim>
std::unique_ptr<const LayerModel<Dim>> make_uniform_layer_model(int count, const Part<Dim>& part);

}  // namespace fabseq
