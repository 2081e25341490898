// SPDX-License-Identifier: MIT
/// \file
/// What the program decides for any number of ranks, asked on one of them: the part that the scaling model
/// (benchmarks/evidence/scaling) takes from the program instead of having rules of its own.
///
///     scaling_plan < QUESTION > ANSWER
///
/// Both are JSON. A question has either a "config", or a "box" and the share of it that is the part's
/// ("fill"); "ranks", numbers of domain ranks; and "deals", each with the "work" of lanes in order and the
/// number of "groups". Answers: what the problems cost, the "systems" (process grid and levels) on each
/// number of ranks, null where the box cannot be dealt out so, and for each deal the blocks of the groups, as
/// [first, lanes].
#include "evidence/scaling/levels.h"
#include "fabseq/base/session.h"
#include "fabseq/config/command_line.h"
#include "fabseq/config/setup.h"
#include "fabseq/parallel/step_dealing.h"
#include "fabseq/process/elastic_model.h"
#include "kernels/kernel_cost.h"
#include "multigrid/lane_multigrid.h"
#include "sequence/heat_sequence.h"
#include "solve/lane_heat.h"

#include <nlohmann/json.hpp>

#include <iostream>
#include <vector>

namespace {

using fabseq::Index;
using Json = nlohmann::json;

constexpr std::integer_sequence<int, 1, 2, 4, 8> widths;

template <class Problem, int... Widths>
Json describe(const fabseq::LaneCycle& cycle, std::integer_sequence<int, Widths...>) {
  const Json flops{{std::to_string(Widths), benchmarks::element_flops<Problem, Widths>()}...};
  return {{"components", Problem::components},
          {"own_operators", Problem::own_operators},
          {"steps", cycle.steps},
          {"patient_steps", cycle.patient_steps},
          {"patient_end", cycle.patient_end},
          {"patience", cycle.patience},
          {"flops", flops}};
}

/// On each number of ranks.
Json systems(const Json& all_ranks, const Index<3>& box, const fabseq::ElementWeights<3>& weights,
             const std::vector<scaling::Level>& elasticity, const std::vector<scaling::Level>& heat) {
  Json result = Json::array();
  for (const int ranks : all_ranks) {
    result.push_back(nullptr);
    if (fabseq::fitting_process_grids<3>(ranks, box).empty()) continue;
    const auto ranges = fabseq::choose_decomposition<3>(PETSC_COMM_SELF, ranks, box, weights);
    result.back() = {{"grid", ranges.processes},
                     {"elasticity", scaling::levels_on(elasticity, ranges)},
                     {"heat", scaling::levels_on(heat, ranges)}};
  }
  return result;
}

Json deal(const Json& question) {
  const std::vector<double> work = question["work"];
  const auto dealt =
      fabseq::deal_out_steps(work, question["groups"], fabseq::widest_block, fabseq::BlockSolver::lanes);
  Json result = Json::array();
  for (const auto& of_group : dealt.blocks) {
    result.push_back(Json::array());
    for (const fabseq::StepBlock& block : of_group) result.back().push_back({block.first, block.lanes});
  }
  return result;
}

Json answer_for_config(const Json& question) {
  fabseq::CommandLine command_line;
  command_line.config_file = question["config"];
  const fabseq::Config config = fabseq::read_config(PETSC_COMM_WORLD, command_line);
  const fabseq::Setup<3> setup(PETSC_COMM_WORLD, config);
  const fabseq::ElasticModel<3> elastic(setup.part, setup.supports, config.material, config.process);
  const fabseq::HeatModel<3> heat(setup.part, {});  // the domain is what counts, whatever the settings
  const fabseq::LaneHierarchy<3> of_elastic(setup.grid, elastic.domain), of_heat(setup.grid, heat.domain);
  const auto whole = setup.grid.all_elements();
  const auto weights = fabseq::element_weights<3>(PETSC_COMM_SELF, setup.grid.domain(), config.part)(whole);
  return {{"part_elements", setup.part.count()},
          {"systems", systems(
                          question["ranks"], whole.size, [&](const auto&) { return weights; },
                          scaling::whole_levels(of_elastic), scaling::whole_levels(of_heat))}};
}

Json answer_for_share(const Json& question) {
  const Index<3> box = question["box"];
  const double fill = question["fill"];
  return {{"part_elements", fill * static_cast<double>(fabseq::IndexBox<3>{{}, box}.count())},
          {"systems", systems(question["ranks"], box, {}, scaling::whole_levels(box, fill, 3),
                              scaling::whole_levels(box, 1.0, 1))}};
}

}  // namespace

int main(int, char** argv) {
  return fabseq::run_session({argv[0]}, [] {
    const Json question = Json::parse(std::cin);
    Json answer = question.contains("config") ? answer_for_config(question) : answer_for_share(question);
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
