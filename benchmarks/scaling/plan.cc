// SPDX-License-Identifier: MIT
/// \file
/// What the program decides for any number of ranks, asked on one of them: the part that the scaling model
/// (benchmarks/scaling_model.py) takes from the program instead of having rules of its own.
///
///     scaling_plan < QUESTIONS > ANSWERS
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
#include "fabseq/optimize/setup.h"
#include "fabseq/parallel/layer_dealing.h"
#include "fabseq/process/elastic_model.h"
#include "fabseq/sequence/heat_model.h"
#include "fabseq/solve/lane_heat.h"

#include <nlohmann/json.hpp>

#include "kernels/kernel_cost.h"
#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <numeric>
#include <set>

namespace {

using fabseq::Index;
using fabseq::LaneMesh;
using Decomposition = fabseq::Decomposition<3>;
using Hierarchy = fabseq::LaneHierarchy<3>;
using Json = nlohmann::json;

constexpr int widest = fabseq::HeatSolver<3>::widest;

/// Counts of a level: of all ranks, and of the one that has most.
struct Level {
  Index<3> box{};                     ///< elements along each axis
  Index<3> factors{};                 ///< to the next level
  const LaneMesh<3>* mesh = nullptr;  ///< of the whole level, if its elements are known
  double elements = 0.0, nodes = 0.0;
  bool distributed = false;
  double own_elements = 0.0, own_nodes = 0.0;
  double halo_messages = 0.0, halo_nodes = 0.0;  ///< of a sum over shared nodes
  double own_neighbors = 0.0, own_halo_nodes = 0.0;
};

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Level, box, elements, nodes, distributed, own_elements, own_nodes,
                                   halo_messages, halo_nodes, own_neighbors, own_halo_nodes)

/// Makes the meshes of all ranks and looks for nodes that several of them hold.
void deal_out(Level& level, const Decomposition& ranges) {
  const int ranks = static_cast<int>(fabseq::IndexBox<3>{{}, ranges.processes}.count());
  std::vector<std::vector<int>> holders(static_cast<std::size_t>(level.mesh->nodes()));
  level.own_elements = level.own_nodes = 0.0;
  for (int rank = 0; rank < ranks; ++rank) {
    const fabseq::IndexBox<3> box = ranges.elements_of(ranges.position_of(rank));
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
  std::vector<std::set<int>> neighbors(static_cast<std::size_t>(ranks));
  std::vector<double> sent(static_cast<std::size_t>(ranks), 0.0);
  for (const std::vector<int>& of_node : holders)
    for (const int rank : of_node) {
      sent[rank] += static_cast<double>(of_node.size()) - 1.0;
      for (const int other : of_node)
        if (other != rank) neighbors[rank].insert(other);
    }
  for (const auto& of_rank : neighbors) {
    level.halo_messages += static_cast<double>(of_rank.size());
    level.own_neighbors = std::max(level.own_neighbors, static_cast<double>(of_rank.size()));
  }
  level.halo_nodes = std::accumulate(sent.begin(), sent.end(), 0.0);
  level.own_halo_nodes = *std::max_element(sent.begin(), sent.end());
}

/// The same where only the filled share of the box is known: the part fills it evenly, and a rank's share of
/// it is a compact one.
void estimate(Level& level, const Index<3>& processes, double fill) {
  const double ranks = static_cast<double>(fabseq::IndexBox<3>{{}, processes}.count());
  double nodes = 1.0, with_halo = 1.0, holders = 1.0, held = 1.0, pairs = 1.0, neighbors = 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double count = processes[axis], extent = level.box[axis], sides = std::min(count - 1.0, 2.0);
    const double edge = fill == 1.0 ? extent / count : std::pow(level.elements / ranks, 1.0 / 3.0);
    nodes *= edge + 1.0;
    with_halo *= edge + 1.0 + sides;
    // A node with h holders is sent h (h - 1) times; h is a product over the axes.
    held *= extent + count;
    holders *= extent + 1.0 + 3.0 * (count - 1.0);
    pairs *= 3.0 * count - 2.0;
    neighbors *= 1.0 + sides;
  }
  level.own_elements = level.elements / ranks;
  level.own_nodes = nodes;
  level.halo_messages = pairs - ranks;
  level.halo_nodes = (holders - held) * fill;
  level.own_neighbors = neighbors - 1.0;
  level.own_halo_nodes = with_halo - nodes;
}

/// The levels of a system as one rank alone has them, and as others would.
class System {
 public:
  System(const fabseq::Grid<3>& grid, const fabseq::SystemDomain& domain)
      : hierarchy_(std::make_unique<Hierarchy>(grid, domain)) {
    for (int index = 0; index < hierarchy_->count(); ++index) {
      const auto& level = hierarchy_->level(index);
      add(level.elements, level.factors, static_cast<double>(level.mesh.elements()),
          static_cast<double>(level.mesh.nodes()));
      whole_.back().mesh = &level.mesh;
    }
  }

  System(Index<3> box, double fill) : fill_(fill) {
    double elements = fill * static_cast<double>(fabseq::IndexBox<3>{{}, box}.count());
    for (Index<3> factors{2, 2, 2}; factors != Index<3>{1, 1, 1};) {
      const double edge = std::pow(elements, 1.0 / 3.0) + 1.0;
      factors = Hierarchy::choose_factors(box, {1.0, 1.0, 1.0}, std::llround(elements));
      add(box, factors, elements,
          fill == 1.0 ? (box[0] + 1.0) * (box[1] + 1.0) * (box[2] + 1.0) : edge * edge * edge);
      for (int& extent : box) extent = (extent + 1) / 2;
      elements = fill == 1.0 ? static_cast<double>(fabseq::IndexBox<3>{{}, box}.count()) : elements / 8.0;
    }
  }

  std::vector<Level> on(Decomposition ranges) const {
    const int ranks = static_cast<int>(fabseq::IndexBox<3>{{}, ranges.processes}.count());
    std::vector<Level> levels;
    for (const Level& whole : whole_) {
      const bool distributed = levels.empty()
                                   ? ranks > 1
                                   : levels.back().distributed &&
                                         Hierarchy::enough_for(ranks, std::llround(whole.elements)) &&
                                         coarsen(ranges, levels.size(), whole.box);
      Level& level = levels.emplace_back(whole);
      level.distributed = distributed;
      if (!distributed) continue;
      if (level.mesh != nullptr)
        deal_out(level, ranges);
      else
        estimate(level, ranges.processes, fill_);
    }
    if (levels.back().distributed) levels.push_back(whole_.back());
    return levels;
  }

 private:
  void add(const Index<3>& box, const Index<3>& factors, double elements, double nodes) {
    whole_.push_back({box, factors, nullptr, elements, nodes, false, elements, nodes});
  }

  /// Takes ranges over to a level; false if not all begin there. Of a part known by its share only, they
  /// begin at multiples of 4, no better, as those of real parts do.
  bool coarsen(Decomposition& ranges, std::size_t level, const Index<3>& box) const {
    const Index<3>& factors = whole_[level - 1].factors;
    if (fill_ < 1.0 && level > 2) return false;
    for (int axis = 0; axis < 3; ++axis) {
      auto& starts = ranges.range_starts[axis];
      for (std::size_t i = 0; i + 1 < starts.size(); ++i) {
        Index<3> start{};
        start[axis] = starts[i];
        if (!Hierarchy::begins_on_next(start, factors)) return false;
        starts[i] /= factors[axis];
      }
      starts.back() = box[axis];
    }
    return true;
  }

  std::unique_ptr<Hierarchy> hierarchy_;
  double fill_ = 1.0;
  std::vector<Level> whole_;
};

template <class Problem>
Json describe(const fabseq::LaneCycle& cycle) {
  using benchmarks::element_flops;
  return {{"components", Problem::components},
          {"own_operators", Problem::own_operators},
          {"steps", cycle.steps},
          {"patient_steps", cycle.patient_steps},
          {"patience", cycle.patience},
          {"flops",
           {{"1", element_flops<Problem, 1>()},
            {"2", element_flops<Problem, 2>()},
            {"4", element_flops<Problem, 4>()},
            {"8", element_flops<Problem, 8>()}}}};
}

/// On each number of ranks.
Json systems(const std::vector<int>& ranks, const Index<3>& box, const fabseq::ElementWeights<3>& weights,
             const System& elasticity, const System& heat) {
  Json result = Json::array();
  for (const int count : ranks) {
    result.push_back(nullptr);
    if (fabseq::fitting_process_grids<3>(count, box).empty()) continue;
    const auto decomposition = fabseq::choose_decomposition<3>(PETSC_COMM_SELF, count, box, weights);
    result.back() = {{"ranks", count},
                     {"grid", decomposition.processes},
                     {"elasticity", elasticity.on(decomposition)},
                     {"heat", heat.on(decomposition)}};
  }
  return result;
}

Json deal(const Json& question) {
  const std::vector<double> work = question["work"];
  Json result = Json::array();
  for (const auto& of_group :
       fabseq::deal_out_layers(work, question["groups"], widest, fabseq::BlockSolver::lanes).blocks) {
    result.push_back(Json::array());
    for (const fabseq::LayerBlock& block : of_group) result.back().push_back({block.first, block.lanes});
  }
  return result;
}

void answer_for_config(const Json& questions, Json& answers) {
  fabseq::CommandLine command_line;
  command_line.config_file = questions["config"];
  const fabseq::Config config = fabseq::read_config(PETSC_COMM_WORLD, command_line);
  const fabseq::Setup<3> setup(PETSC_COMM_WORLD, config);
  const fabseq::ElasticModel<3> elastic(setup.part, setup.supports, config.material, config.process);
  const fabseq::HeatModel<3> heat(setup.part, config.sequence);
  const auto weights =
      fabseq::element_weights<3>(PETSC_COMM_SELF, config.domain<3>(), config.part)(setup.grid.all_elements());
  const Index<3> box = setup.grid.domain().elements;
  answers["box"] = box;
  answers["part_elements"] = setup.part.count();
  answers["layers"] = setup.layer_count;
  answers["systems"] = systems(
      questions["ranks"], box, [&](const fabseq::IndexBox<3>&) { return weights; },
      System(setup.grid, elastic.domain), System(setup.grid, heat.domain));
}

void answer_for_share(const Json& questions, Json& answers) {
  const Index<3> box = questions["box"];
  const double fill = questions["fill"];
  answers["box"] = box;
  answers["part_elements"] = fill * static_cast<double>(fabseq::IndexBox<3>{{}, box}.count());
  answers["systems"] = systems(questions["ranks"], box, {}, System(box, fill), System(box, 1.0));
}

}  // namespace

int main(int, char** argv) {
  return fabseq::run_session({argv[0]}, [] {
    const Json questions = Json::parse(std::cin);
    Json answers;
    (questions.contains("config") ? answer_for_config : answer_for_share)(questions, answers);
    answers["problems"] = {{"elasticity", describe<fabseq::LaneElasticityProblem<3>>({})},
                           {"heat", describe<fabseq::LaneHeatProblem<3>>(fabseq::LaneHeat<3>::cycle())}};
    for (const int width : {1, 2, 4, 8})
      answers["relative_cost"][std::to_string(width)] =
          fabseq::block_work(std::vector<double>(width, 1.0), fabseq::BlockSolver::lanes);
    for (const Json& question : questions["deals"]) answers["deals"].push_back(deal(question));
    std::cout << answers << '\n';
  });
}
