// SPDX-License-Identifier: MIT
/// \file
/// What the program decides for any number of ranks, asked on one of them: the part that the scaling model
/// (benchmarks/scaling_model.py) takes from the program instead of having rules of its own.
///
///     scaling_plan < QUESTION > ANSWER
///
/// Both are JSON. A question has either a "config", or a "box" and the share of it that is the part's
/// ("fill"); "ranks", numbers of domain ranks; and "deals", each with the "work" of lanes in order and the
/// number of "groups". Answers: what the problems cost, the "systems" (process grid and levels) on each
/// number of ranks, null where the box cannot be dealt out so, and for each deal the blocks of the groups, as
/// [first, lanes].
#include "fabseq/base/session.h"
#include "fabseq/config/command_line.h"
#include "fabseq/lanes/lane_hierarchy.h"
#include "fabseq/lanes/lane_multigrid.h"
#include "fabseq/parallel/layer_dealing.h"
#include "fabseq/process/elastic_model.h"
#include "fabseq/run/setup.h"
#include "fabseq/sequence/heat_model.h"
#include "fabseq/solve/lane_heat.h"

#include <nlohmann/json.hpp>

#include "kernels/kernel_cost.h"
#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <set>

namespace {

using fabseq::Index;
using fabseq::LaneMesh;
using Decomposition = fabseq::Decomposition<3>;
using Hierarchy = fabseq::LaneHierarchy<3>;
using Json = nlohmann::json;

double count_of(const Index<3>& box) { return static_cast<double>(fabseq::IndexBox<3>{{}, box}.count()); }

/// Counts of a level: of all ranks, and of the one that has most.
struct Level {
  Index<3> box{};                     ///< elements along each axis
  Index<3> factors{};                 ///< to the next level
  const LaneMesh<3>* mesh = nullptr;  ///< of the whole level, if its elements are known
  double elements = 0.0, nodes = 0.0;
  double own_elements = elements, own_nodes = nodes;
  bool distributed = false;
  double halo_messages = 0.0, halo_nodes = 0.0;  ///< of a sum over shared nodes
  double own_neighbors = 0.0, own_halo_nodes = 0.0;
};

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Level, box, elements, nodes, distributed, own_elements, own_nodes,
                                   halo_messages, halo_nodes, own_neighbors, own_halo_nodes)

/// Makes the meshes of all ranks and looks for nodes that several of them hold.
void deal_out(Level& level, const Decomposition& ranges) {
  const auto ranks = static_cast<std::size_t>(count_of(ranges.processes));
  std::vector<std::vector<std::size_t>> holders(static_cast<std::size_t>(level.mesh->nodes()));
  level.own_elements = level.own_nodes = 0.0;
  for (std::size_t rank = 0; rank < ranks; ++rank) {
    const auto box = ranges.elements_of(ranges.position_of(static_cast<int>(rank)));
    std::vector<char> active(static_cast<std::size_t>(box.count()));
    box.for_each([&](const Index<3>& element, std::int64_t offset) {
      active[offset] = level.mesh->element_number(element) >= 0 ? 1 : 0;
    });
    const LaneMesh<3> mesh(box, active);
    level.own_elements = std::max(level.own_elements, static_cast<double>(mesh.elements()));
    level.own_nodes = std::max(level.own_nodes, static_cast<double>(mesh.nodes()));
    for (const auto& run : mesh.node_runs())
      for (int i = 0; i < run.length; ++i)
        holders[level.mesh->node_number({run.index[0] + i, run.index[1], run.index[2]})].push_back(rank);
  }
  std::vector<std::set<std::size_t>> neighbors(ranks);
  std::vector<double> sent(ranks, 0.0);
  for (const auto& of_node : holders)
    for (const std::size_t rank : of_node) {
      sent[rank] += static_cast<double>(of_node.size() - 1);
      for (const std::size_t other : of_node)
        if (other != rank) neighbors[rank].insert(other);
    }
  for (std::size_t rank = 0; rank < ranks; ++rank) {
    const auto messages = static_cast<double>(neighbors[rank].size());
    level.halo_messages += messages;
    level.halo_nodes += sent[rank];
    level.own_neighbors = std::max(level.own_neighbors, messages);
    level.own_halo_nodes = std::max(level.own_halo_nodes, sent[rank]);
  }
}

/// The same where only the filled share of the box is known: the part fills it evenly, and a rank's share of
/// it is a compact one.
void estimate(Level& level, const Index<3>& processes, double fill) {
  const double ranks = count_of(processes);
  double nodes = 1.0, with_halo = 1.0, squares = 1.0, holders = 1.0, pairs = 1.0, around = 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double count = processes[axis], extent = level.box[axis], sides = std::min(count - 1.0, 2.0);
    const double edge = fill == 1.0 ? extent / count : std::pow(level.elements / ranks, 1.0 / 3.0);
    nodes *= edge + 1.0;
    with_halo *= edge + 1.0 + sides;
    // A node with h holders is sent h (h - 1) times; h is a product over the axes.
    squares *= extent + 1.0 + 3.0 * (count - 1.0);
    holders *= extent + count;
    pairs *= 3.0 * count - 2.0;
    around *= 1.0 + sides;
  }
  level.own_elements = level.elements / ranks;
  level.own_nodes = nodes;
  level.halo_messages = pairs - ranks;
  level.halo_nodes = (squares - holders) * fill;
  level.own_neighbors = around - 1.0;
  level.own_halo_nodes = with_halo - nodes;
}

/// The levels of a system as one rank alone has them, and as others would.
class System {
 public:
  System(const fabseq::Grid<3>& grid, const fabseq::SystemDomain& domain)
      : hierarchy_(std::make_unique<Hierarchy>(grid, domain)) {
    for (int index = 0; index < hierarchy_->count(); ++index) {
      const auto& level = hierarchy_->level(index);
      whole_.push_back({level.elements, level.factors, &level.mesh,
                        static_cast<double>(level.mesh.elements()), static_cast<double>(level.mesh.nodes())});
    }
  }

  System(Index<3> box, double fill) : fill_(fill) {
    const bool full = fill == 1.0;
    double elements = fill * count_of(box);
    for (Index<3> factors{}; factors != Index<3>{1, 1, 1};) {
      factors = Hierarchy::choose_factors(box, {1.0, 1.0, 1.0}, std::llround(elements));
      whole_.push_back({box, factors, nullptr, elements,
                        full ? count_of({box[0] + 1, box[1] + 1, box[2] + 1})
                             : std::pow(std::pow(elements, 1.0 / 3.0) + 1.0, 3)});
      for (int& extent : box) extent = (extent + 1) / 2;
      elements = full ? count_of(box) : elements / 8.0;
    }
  }

  std::vector<Level> on(Decomposition ranges) const {
    const auto ranks = static_cast<int>(count_of(ranges.processes));
    std::vector<Level> levels;
    for (const Level& whole : whole_) {
      const bool distributed = levels.empty()
                                   ? ranks > 1
                                   : levels.back().distributed &&
                                         Hierarchy::enough_for(ranks, std::llround(whole.elements)) &&
                                         coarsen(ranges, levels);
      Level& level = levels.emplace_back(whole);
      level.distributed = distributed;
      if (distributed && level.mesh != nullptr) deal_out(level, ranges);
      if (distributed && level.mesh == nullptr) estimate(level, ranges.processes, fill_);
    }
    if (levels.back().distributed) levels.push_back(whole_.back());
    return levels;
  }

 private:
  /// Takes ranges over to the level after those given; false if not all begin there. Ranges of a part known
  /// by its share only begin at multiples of 4, no better, as those of real parts do.
  bool coarsen(Decomposition& ranges, const std::vector<Level>& finer) const {
    if (fill_ < 1.0 && finer.size() > 2) return false;
    for (int axis = 0; axis < 3; ++axis)
      for (int& start : ranges.range_starts[axis]) {
        const bool end = &start == &ranges.range_starts[axis].back();
        Index<3> first{};
        first[axis] = start;
        if (!end && !Hierarchy::begins_on_next(first, finer.back().factors)) return false;
        start = end ? whole_[finer.size()].box[axis] : start / finer.back().factors[axis];
      }
    return true;
  }

  std::unique_ptr<Hierarchy> hierarchy_;
  double fill_ = 1.0;
  std::vector<Level> whole_;
};

constexpr std::integer_sequence<int, 1, 2, 4, 8> widths;

template <class Problem, int... Widths>
Json describe(const fabseq::LaneCycle& cycle, std::integer_sequence<int, Widths...>) {
  const Json flops{{std::to_string(Widths), benchmarks::element_flops<Problem, Widths>()}...};
  return {{"components", Problem::components},
          {"own_operators", Problem::own_operators},
          {"steps", cycle.steps},
          {"patient_steps", cycle.patient_steps},
          {"patience", cycle.patience},
          {"flops", flops}};
}

/// On each number of ranks.
Json systems(const Json& all_ranks, const Index<3>& box, const fabseq::ElementWeights<3>& weights,
             const System& elasticity, const System& heat) {
  Json result = Json::array();
  for (const int ranks : all_ranks) {
    result.push_back(nullptr);
    if (fabseq::fitting_process_grids<3>(ranks, box).empty()) continue;
    const auto ranges = fabseq::choose_decomposition<3>(PETSC_COMM_SELF, ranks, box, weights);
    result.back() = {
        {"grid", ranges.processes}, {"elasticity", elasticity.on(ranges)}, {"heat", heat.on(ranges)}};
  }
  return result;
}

Json deal(const Json& question) {
  const std::vector<double> work = question["work"];
  const auto dealt = fabseq::deal_out_layers(work, question["groups"], fabseq::HeatSolver<3>::widest,
                                             fabseq::BlockSolver::lanes);
  Json result = Json::array();
  for (const auto& of_group : dealt.blocks) {
    result.push_back(Json::array());
    for (const fabseq::LayerBlock& block : of_group) result.back().push_back({block.first, block.lanes});
  }
  return result;
}

Json answer_for_config(const Json& question) {
  fabseq::CommandLine command_line;
  command_line.config_file = question["config"];
  const fabseq::Config config = fabseq::read_config(PETSC_COMM_WORLD, command_line);
  const fabseq::Setup<3> setup(PETSC_COMM_WORLD, config);
  const fabseq::ElasticModel<3> elastic(setup.part, setup.supports, config.material, config.process);
  const fabseq::HeatModel<3> heat(setup.part, config.sequence);
  const auto whole = setup.grid.all_elements();
  const auto weights = fabseq::element_weights<3>(PETSC_COMM_SELF, setup.grid.domain(), config.part)(whole);
  return {{"part_elements", setup.part.count()},
          {"systems", systems(
                          question["ranks"], whole.size, [&](const auto&) { return weights; },
                          System(setup.grid, elastic.domain), System(setup.grid, heat.domain))}};
}

Json answer_for_share(const Json& question) {
  const Index<3> box = question["box"];
  const double fill = question["fill"];
  return {{"part_elements", fill * count_of(box)},
          {"systems", systems(question["ranks"], box, {}, System(box, fill), System(box, 1.0))}};
}

}  // namespace

int main(int, char** argv) {
  return fabseq::run_session({argv[0]}, [] {
    const Json question = Json::parse(std::cin);
    Json answer = question.contains("config") ? answer_for_config(question) : answer_for_share(question);
    answer["agglomeration_limit"] = std::int64_t{Hierarchy::agglomeration_limit};
    answer["problems"] = {
        {"elasticity", describe<fabseq::LaneElasticityProblem<3>>({}, widths)},
        {"heat", describe<fabseq::LaneHeatProblem<3>>(fabseq::LaneHeat<3>::cycle(), widths)}};
    for (const int width : {1, 2, 4, 8})
      answer["relative_cost"][std::to_string(width)] =
          fabseq::block_work(std::vector<double>(width, 1.0), fabseq::BlockSolver::lanes);
    for (const Json& of_deal : question["deals"]) answer["deals"].push_back(deal(of_deal));
    std::cout << answer << '\n';
  });
}
