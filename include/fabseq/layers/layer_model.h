// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/base/json.h"
#include "fabseq/layers/layer_settings.h"
#include "fabseq/layers/layers.h"
#include "fabseq/part/part.h"

#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace fabseq {

/// Design variables of the layers themselves, beside the sequence's: time points or print angles. They are
/// few and the same on all ranks; without any, all lists are empty.
struct LayerVariables {
  std::string name;                  ///< in files: time_points, angles
  std::string label;                 ///< in messages
  std::vector<double> start;         ///< the design to start from
  std::vector<double> lower, upper;  ///< bounds
  /// The optimizer's range of a variable: so far to either side of where it is, within the bounds.
  double reach = std::numeric_limits<double>::infinity();
  /// Columns of its table in files, [sub-part][angle]; 0: a plain list.
  int columns = 0;
  bool fixed = false;  ///< part of every design, but kept from the optimizer

  std::size_t count() const { return start.size(); }
  /// Values as a list, or per sub-part a list.
  Json record(std::span<const double> values) const;
};

/// T_1 ... T_{N-1} of curved layers (docs/formulation.md 3.1); one layer has none.
LayerVariables time_point_variables(int layers);

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
  LayerModel(LayerModel&&) = delete;

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

}  // namespace fabseq
