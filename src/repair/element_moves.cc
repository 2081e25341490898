// SPDX-License-Identifier: MIT
#include "repair/element_moves.h"

#include "fabseq/base/mpi.h"
#include "fabseq/grid/components.h"
#include "fabseq/grid/element_halo.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace fabseq {

namespace {

/// How far from the ends of a layer's time the time of an element is that moves into it, in layers.
constexpr double inside = 0.25;

constexpr std::size_t index_of(Fault fault) { return static_cast<std::size_t>(fault) - 1; }

template <int Dim>
class ElementMoves {
 public:
  ElementMoves(const Model<Dim>& model, const Layers& layers, const CutTime<Dim>& start, double most_elements)
      : model_(model), layers_(layers), start_(start), most_elements_(most_elements), halo_(model.grid, 1) {}

  CutTime<Dim> run() const {
    CutTime<Dim> now = start_;
    for (int round = 1; round < now.densities.count() && now.in_all() > 0; ++round) {
      CutTime<Dim> next = moved(now);
      if (!any(comm(), next.layer != now.layer) || moves_too_many(next)) break;
      now = std::move(next);
    }
    // What is undone may be what others rest on: until nothing changes.
    for (int round = 0; round < most_undone && now.in_all() > 0; ++round) {
      CutTime<Dim> next = without_faulty_moves(now);
      const bool same = !any(comm(), next.layer != now.layer);
      now = std::move(next);
      if (same) break;
    }
    return one_by_one(now.is_better_than(start_) ? std::move(now) : start_);
  }

 private:
  static constexpr int most_undone = 10;
  static constexpr int most_passes = 3;
  static constexpr std::size_t most_tried = 12;

  MPI_Comm comm() const { return model_.grid.comm(); }
  bool moves_too_many(const CutTime<Dim>& cut) const {
    return static_cast<double>(count_moved(model_.part, start_, cut)) > most_elements_;
  }

  /// What is tried for an element that fails: another layer, and the build direction of a neighbour.
  struct Trial {
    int way = 0;
    int axis = -1, side = 0;  ///< of the neighbour; -1: its own direction
  };
  static std::vector<Trial> trials() {
    std::vector<Trial> result;
    for (const int way : {1, -1, 2, -2, 3, -3}) result.push_back({way});
    for (const int way : {0, 1, -1})
      for (int axis = 0; axis < Dim; ++axis)
        for (const int side : {-1, 1}) result.push_back({way, axis, side});
    return result;
  }

  /// Tries these for each element that fails, until nothing gets better.
  CutTime<Dim> one_by_one(CutTime<Dim> now) const {
    for (int pass = 0; pass < most_passes && now.in_all() > 0; ++pass) {
      const std::int64_t before = now.in_all();
      for (const std::int64_t number : failing_numbers(now)) now = best_trial(std::move(now), number);
      if (now.in_all() == before) break;
    }
    return now;
  }
  std::vector<std::int64_t> failing_numbers(const CutTime<Dim>& now) const {
    std::vector<std::int64_t> own;
    for (std::size_t e = 0; e < now.layer.size(); ++e)
      if (now.fails(e)) own.push_back(number_in_grid(model_.part, e));
    std::vector<std::int64_t> result = gather_all(comm(), own);
    std::sort(result.begin(), result.end());
    result.resize(std::min(result.size(), most_tried));
    return result;
  }
  /// The first one that makes it better, if any does.
  CutTime<Dim> best_trial(CutTime<Dim> now, std::int64_t number) const {
    const std::array<std::vector<double>, Dim> gradients = gathered_gradients(now);
    for (const Trial& trial : trials()) {
      std::optional<CutTime<Dim>> tried = with(now, number, trial, gradients);
      if (tried && tried->is_better_than(now) && !moves_too_many(*tried)) return *std::move(tried);
    }
    return now;
  }
  /// Components of the gradient on the halo's box, no numbers outside the part.
  std::array<std::vector<double>, Dim> gathered_gradients(const CutTime<Dim>& now) const {
    std::array<std::vector<double>, Dim> result;
    const std::vector<double>& gradient = now.time.gradient;
    for (int i = 0; i < Dim; ++i) {
      std::vector<double> component(now.layer.size(), NAN);
      for (std::size_t e = 0; e < component.size() && !gradient.empty(); ++e)
        component[e] = gradient[e * Dim + i];
      result[i] = halo_.gather(model_.part.expand(component, NAN));
    }
    return result;
  }

  /// The layers with a trial for one element; none if it has no such neighbour with a gradient.
  std::optional<CutTime<Dim>> with(const CutTime<Dim>& now, std::int64_t number, const Trial& trial,
                                   const std::array<std::vector<double>, Dim>& gradients) const {
    PseudoTime<Dim> time = now.time;
    bool found = false;
    for (std::size_t e = 0; e < now.layer.size(); ++e)
      if (number_in_grid(model_.part, e) == number) {
        found = trial.axis < 0 || take_gradient(e, trial, gradients, time);
        if (trial.way != 0) time.time[e] = time_in(now, e, trial.way);
      }
    if (!any(comm(), found)) return std::nullopt;
    return cut(model_, layers_, std::move(time));
  }
  /// Gives an element its neighbour's gradient. Returns false if there is none.
  bool take_gradient(std::size_t e, const Trial& trial, const std::array<std::vector<double>, Dim>& gradients,
                     PseudoTime<Dim>& time) const {
    Index<Dim> neighbour = model_.grid.owned_elements().index(model_.part.elements()[e]);
    neighbour[trial.axis] += trial.side;
    if (!halo_.box().contains(neighbour)) return false;
    const std::int64_t offset = halo_.box().offset(neighbour);
    if (std::isnan(gradients[0][offset])) return false;
    for (int i = 0; i < Dim; ++i) time.gradient[e * Dim + i] = gradients[i][offset];
    return true;
  }

  CutTime<Dim> moved(const CutTime<Dim>& now) const {
    PseudoTime<Dim> time = now.time;
    for (std::size_t e = 0; e < time.time.size(); ++e)
      if (const int way = way_of(now, e); way != 0) time.time[e] = time_in(now, e, way);
    return cut(model_, layers_, std::move(time));
  }
  /// 1: the element comes a layer later, -1: earlier, 0: it stays.
  int way_of(const CutTime<Dim>& now, std::size_t e) const {
    const auto fails = [&](Fault fault) {
      const std::vector<double>& marks = now.marks[index_of(fault)];
      return !marks.empty() && marks[e] > 0.0;
    };
    // Back and forth leads nowhere.
    if (fails(Fault::hanging)) return now.layer[e] >= start_.layer[e] ? 1 : 0;
    if (fails(Fault::blocked)) return now.layer[e] <= start_.layer[e] ? -1 : 0;
    return 0;
  }
  double time_in(const CutTime<Dim>& now, std::size_t e, int way) const {
    const auto& points = now.densities.time_points;
    const int layer = std::clamp(static_cast<int>(now.layer[e]) + way, 1, now.densities.count());
    const double duration = points[layer] - points[layer - 1];
    return std::clamp(now.time.time[e], points[layer - 1] + inside * duration,
                      points[layer] - inside * duration);
  }

  /// Undoes the moves that are joined to a fault.
  CutTime<Dim> without_faulty_moves(const CutTime<Dim>& now) const {
    std::vector<double> marks(now.layer.size());
    for (std::size_t e = 0; e < marks.size(); ++e)
      marks[e] = now.layer[e] != start_.layer[e] || now.fails(e) ? 1.0 : 0.0;
    const Components components =
        find_components<Dim>(model_.grid, model_.part.expand(marks), Contact::corner);
    std::vector<double> faulty(static_cast<std::size_t>(components.count), 0.0);
    const auto component_of = [&](std::size_t e) { return components.of_element[model_.part.elements()[e]]; };
    for (std::size_t e = 0; e < marks.size(); ++e)
      if (now.fails(e)) faulty[component_of(e)] = 1.0;
    max_in_place(comm(), faulty);
    PseudoTime<Dim> time = now.time;
    for (std::size_t e = 0; e < marks.size(); ++e)
      if (marks[e] > 0.0 && faulty[component_of(e)] > 0.0) time.time[e] = start_.time.time[e];
    return cut(model_, layers_, std::move(time));
  }

  const Model<Dim>& model_;
  const Layers& layers_;
  const CutTime<Dim>& start_;
  double most_elements_;
  ElementHalo<Dim> halo_;
};

}  // namespace

template <int Dim>
CutTime<Dim> move_elements(const Model<Dim>& model, const Layers& layers, const CutTime<Dim>& start,
                           double most_elements) {
  return ElementMoves<Dim>(model, layers, start, most_elements).run();
}

FABSEQ_INSTANTIATE_FUNCTION(move_elements);

}  // namespace fabseq
