// SPDX-License-Identifier: MIT
#include "repair/element_moves.h"

#include "fabseq/base/mpi.h"
#include "fabseq/grid/components.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace fabseq {

namespace {

/// How far from the ends of a layer's time the time of an element is that moves into it, in layers.
constexpr double inside = 0.25;

constexpr std::size_t index_of(Fault fault) { return static_cast<std::size_t>(fault) - 1; }

template <int Dim>
class ElementMoves {
 public:
  ElementMoves(const Model<Dim>& model, const Layers& layers, const CutTime<Dim>& start, double most_elements)
      : model_(model), layers_(layers), start_(start), most_elements_(most_elements) {}

  CutTime<Dim> run() const {
    CutTime<Dim> now = start_;
    for (int round = 1; round < now.densities.count() && now.in_all() > 0; ++round) {
      CutTime<Dim> next = moved(now);
      if (!any(comm(), next.layer != now.layer) || moves(next) > most_elements_) break;
      now = std::move(next);
    }
    // What is undone may be what others rest on: until nothing changes.
    for (int round = 0; round < most_undone && now.in_all() > 0; ++round) {
      CutTime<Dim> next = without_faulty_moves(now);
      const bool same = !any(comm(), next.layer != now.layer);
      now = std::move(next);
      if (same) break;
    }
    return now.is_better_than(start_) ? std::move(now) : start_;
  }

 private:
  static constexpr int most_undone = 10;

  MPI_Comm comm() const { return model_.grid.comm(); }
  double moves(const CutTime<Dim>& cut) const {
    double count = 0.0;
    for (std::size_t e = 0; e < cut.layer.size(); ++e) count += cut.layer[e] != start_.layer[e] ? 1.0 : 0.0;
    return sum(comm(), count);
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
};

}  // namespace

template <int Dim>
CutTime<Dim> move_elements(const Model<Dim>& model, const Layers& layers, const CutTime<Dim>& start,
                           double most_elements) {
  return ElementMoves<Dim>(model, layers, start, most_elements).run();
}

FABSEQ_INSTANTIATE_FUNCTION(move_elements);

}  // namespace fabseq
