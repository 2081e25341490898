// SPDX-License-Identifier: MIT
/// Objective: distortion measures, all quadratic in the displacement (docs/formulation.md 5). With
/// `after_release` they measure the displacement u + v of the part cut from its supports (4.3).
#include "fabseq/base/error.h"
#include "fabseq/base/mpi.h"
#include "fabseq/responses/distortion_functionals.h"
#include "fabseq/responses/response_type.h"
#include "fabseq/responses/set_displacement.h"
#include "fabseq/responses/shape_deviation.h"

#include <algorithm>
#include <numeric>

namespace fabseq {

namespace {

enum class Measure { displacement, flatness, layerwise, shape };
constexpr const char* measure_names = "displacement flatness layerwise shape";

struct DistortionSettings {
  Measure measure = Measure::displacement;
  std::string nodes;  ///< name of a node set
  int axis = -1;      ///< for `flatness`; -1: not given
  bool mean = false;
  bool after_release = false;
  std::vector<std::string> fit = {"translation", "rotation"};  ///< of shape
  std::optional<bool> least_squares;  ///< none: with scaling `current`, while the squares hold most of it

  bool measures_release() const { return after_release; }
  std::vector<std::string> node_sets() const {
    return nodes.empty() ? std::vector<std::string>{} : std::vector<std::string>{nodes};
  }
  void check(const TermPlace& place) const;
  bool fits(const char* motion) const { return std::find(fit.begin(), fit.end(), motion) != fit.end(); }

 private:
  void check_node_set(const TermPlace& place) const;
  std::string with_measure() const {
    return " with measure " + split(measure_names, ' ')[static_cast<std::size_t>(measure)];
  }
};

/// The functionals of a measure on a node set, nullptr if the optimizer is not to have them. "auto" leaves
/// terms with the published scaling as they were published.
template <int Dim>
std::unique_ptr<SumOfSquares<Dim>> squares_of(const DistortionSettings& settings, TermScaling scaling,
                                              const SetDisplacement<Dim>& set, std::vector<int> axes,
                                              bool means, double factor) {
  if (!settings.least_squares.value_or(scaling == TermScaling::current)) return nullptr;
  return std::make_unique<DistortionFunctionals<Dim>>(set, std::move(axes), means, factor,
                                                      settings.least_squares.has_value());
}

/// `displacement`: sum (or mean) over the set's nodes of |u|^2.
template <int Dim>
class Displacement : public Response<Dim> {
 public:
  Displacement(const SetDisplacement<Dim>& set, const DistortionSettings& settings)
      : set_(set),
        settings_(settings),
        factor_(settings.mean ? 1.0 / static_cast<double>(set.nodes().count) : 1.0) {}

  std::string type() const override { return "distortion"; }
  bool uses_displacements() const override { return true; }

  std::vector<double> values(const PipelineState<Dim>& state) const override {
    double square = 0.0;
    for (const int node : set_.nodes().owned)
      for (int axis = 0; axis < Dim; ++axis) {
        const double u = set_.at(state, node, axis);
        square += u * u;
      }
    return {factor_ * sum(set_.comm(), square)};
  }

  void add_derivative(int, double weight, const PipelineState<Dim>& state,
                      PipelineAdjoint<Dim>& adjoint) const override {
    set_.prepare(state, adjoint);
    for (const int node : set_.nodes().owned)
      for (int axis = 0; axis < Dim; ++axis)
        set_.add_derivative(node, axis, 2.0 * weight * factor_ * set_.at(state, node, axis), state, adjoint);
  }

  std::unique_ptr<SumOfSquares<Dim>> squares(TermScaling scaling) const override {
    std::vector<int> axes(Dim);
    std::iota(axes.begin(), axes.end(), 0);
    return squares_of(settings_, scaling, set_, std::move(axes), true, factor_);
  }

 private:
  SetDisplacement<Dim> set_;
  DistortionSettings settings_;
  double factor_;
};

/// `flatness` along an axis: mean over the set's nodes of (u_a - mean of u_a)^2.
template <int Dim>
class Flatness : public Response<Dim> {
 public:
  Flatness(const SetDisplacement<Dim>& set, const DistortionSettings& settings)
      : set_(set), settings_(settings), axis_(settings.axis) {}

  std::string type() const override { return "distortion"; }
  bool uses_displacements() const override { return true; }

  std::vector<double> values(const PipelineState<Dim>& state) const override {
    const double average = mean(state);
    double square = 0.0;
    for (const int node : set_.nodes().owned) {
      const double deviation = set_.at(state, node, axis_) - average;
      square += deviation * deviation;
    }
    return {sum(set_.comm(), square) / static_cast<double>(set_.nodes().count)};
  }

  void add_derivative(int, double weight, const PipelineState<Dim>& state,
                      PipelineAdjoint<Dim>& adjoint) const override {
    // The derivative of the mean drops out because the deviations sum to zero.
    const double average = mean(state);
    set_.prepare(state, adjoint);
    for (const int node : set_.nodes().owned) {
      const double deviation = set_.at(state, node, axis_) - average;
      set_.add_derivative(node, axis_, 2.0 * weight / static_cast<double>(set_.nodes().count) * deviation,
                          state, adjoint);
    }
  }

  std::unique_ptr<SumOfSquares<Dim>> squares(TermScaling scaling) const override {
    return squares_of(settings_, scaling, set_, {axis_}, false,
                      1.0 / static_cast<double>(set_.nodes().count));
  }

 private:
  double mean(const PipelineState<Dim>& state) const {
    double total = 0.0;
    for (const int node : set_.nodes().owned) total += set_.at(state, node, axis_);
    return sum(set_.comm(), total) / static_cast<double>(set_.nodes().count);
  }

  SetDisplacement<Dim> set_;
  DistortionSettings settings_;
  int axis_;
};

/// `layerwise`: sum over layers and all nodes of |increment|^2.
template <int Dim>
class Layerwise : public Response<Dim> {
 public:
  std::string type() const override { return "distortion"; }
  bool uses_displacements() const override { return true; }

  std::vector<double> values(const PipelineState<Dim>& state) const override {
    double square = 0.0;
    const auto& increments = state.process.increments;
    for (std::size_t batch = 0; batch < increments.size(); ++batch)
      for (std::size_t i = 0; i < increments[batch].unknowns(); ++i)
        for (int lane = 0; lane < increments[batch].lanes; ++lane) {
          const double u = state.process.counted(batch, i, lane);
          square += u * u;
        }
    return {sum(state.process.all_layers, square)};
  }

  void add_derivative(int, double weight, const PipelineState<Dim>& state,
                      PipelineAdjoint<Dim>& adjoint) const override {
    auto& derivative = adjoint.process.increments;
    for (std::size_t batch = 0; batch < state.process.increments.size(); ++batch) {
      const LaneVector& increments = state.process.increments[batch];
      if (derivative.size() <= batch)
        derivative.emplace_back(increments.nodes, increments.components, increments.lanes);
      for (std::size_t i = 0; i < increments.unknowns(); ++i)
        for (int lane = 0; lane < increments.lanes; ++lane)
          derivative[batch](i, lane) += 2.0 * weight * state.process.counted(batch, i, lane);
    }
  }
};

template <int Dim>
struct Distortion {
  static std::unique_ptr<Response<Dim>> make(const ResponseContext<Dim>& context,
                                             const DistortionSettings& settings) {
    if (settings.measure == Measure::layerwise) return std::make_unique<Layerwise<Dim>>();
    const SetDisplacement<Dim> set(context.part, context.node_sets.at(settings.nodes),
                                   settings.after_release);
    if (settings.measure == Measure::shape)
      return make_shape_deviation(set, {settings.fits("rotation"), settings.fits("scale")});
    if (settings.measure == Measure::flatness) return std::make_unique<Flatness<Dim>>(set, settings);
    return std::make_unique<Displacement<Dim>>(set, settings);
  }
};

void DistortionSettings::check_node_set(const TermPlace& place) const {
  const std::string pointer = pointer_to(place.pointer, "nodes");
  const std::vector<std::string>& known = place.node_sets;
  const std::string list = known.empty() ? "none, as node_sets is empty" : join(known, ", ");
  if (nodes.empty()) throw InputError(pointer + ": missing; allowed: name of a node set (" + list + ")");
  if (std::find(known.begin(), known.end(), nodes) != known.end()) return;
  const std::string nearest = nearest_word(nodes, known);
  const std::string hint = nearest.empty() ? "" : ", did you mean \"" + nearest + "\"?";
  refuse(pointer, "unknown node set " + shown(nodes) + hint, list);
}

void DistortionSettings::check(const TermPlace& place) const {
  const auto at = [&](const char* key) { return pointer_to(place.pointer, key); };
  const bool layerwise = measure == Measure::layerwise;
  if (!layerwise) check_node_set(place);
  if (layerwise && !nodes.empty())
    refuse(at("nodes"), shown(nodes), "no node set with measure layerwise, which takes all nodes");
  if (measure == Measure::flatness && axis < 0)
    throw InputError(at("axis") + ": missing; allowed: " + (place.dimension == 2 ? "x, y" : "x, y, z"));
  if (measure != Measure::flatness && axis >= 0)
    refuse(at("axis"), shown(std::string(1, static_cast<char>('x' + axis))), "only with measure flatness");
  if (mean && measure != Measure::displacement)
    refuse(at("mean"), "true" + with_measure(), "true only with measure displacement");
  if (layerwise && after_release)
    refuse(at("after_release"), "true" + with_measure(),
           "true only with measures displacement, flatness and shape");
  if ((layerwise || measure == Measure::shape) && least_squares.value_or(false))
    refuse(at("least_squares"), "true" + with_measure(),
           "true only with measures displacement and flatness; \"auto\" or false");
  if (!fits("translation"))
    refuse(at("fit"), shown(fit), "a list with \"translation\", and with \"rotation\" and \"scale\" or not");
}

Section<DistortionSettings> distortion_keys() {
  using Its = DistortionSettings;
  return Section<Its>("objective")
      .key("measure", &Its::measure,
           "Squared displacement over a node set, its flatness along an axis, the squared displacement of "
           "every "
           "layer over all nodes, or the mean squared deviation of a node set's shape from a best fit",
           {.words = measure_names})
      .key("nodes", &Its::nodes, "Node set of displacement, flatness and shape (required)")
      .key("axis", &Its::axis, "Axis of flatness (required)", {.type = KeyType::axis})
      .key("fit", "What the best fit of shape may move: translation, always, rotation and scale",
           {.type = KeyType::word_list,
            .default_value = to_text(Its{}.fit),
            .words = "translation rotation scale"},
           [](Its& settings, const Json& value, const KeyPlace&) { value.get_to(settings.fit); })
      .key("mean", &Its::mean, "Divide displacement by the number of nodes")
      .key("after_release", &Its::after_release,
           "Measure displacement, flatness or shape after the release from plate or clamps")
      .key("least_squares", &Its::least_squares,
           "Hand displacement or flatness to the optimizer as a sum of squares, an elastic adjoint each; "
           "auto: "
           "with scaling current, while these hold most of it",
           {.words = "auto"});
}

const Registered<Distortion, DistortionSettings> registered({.name = "distortion",
                                                             .scaling = TermScaling::current},
                                                            distortion_keys());

}  // namespace

}  // namespace fabseq
