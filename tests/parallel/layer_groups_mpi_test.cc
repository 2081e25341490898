// SPDX-License-Identifier: MIT
/// Groups of ranks: shares and sums, and the pipeline with groups against the same without.
#include "fabseq/base/error.h"
#include "fabseq/parallel/layer_groups.h"
#include "support/pipeline_case.h"
#include "support/whole_field.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>
#include <vector>

namespace fabseq {
namespace {

const MPI_Comm world = MPI_COMM_WORLD;

/// Every number of groups that these ranks allow.
std::vector<int> group_counts() {
  std::vector<int> result;
  for (int count = 1; count <= size_of(world); ++count)
    if (size_of(world) % count == 0) result.push_back(count);
  return result;
}

/// A field of its own for each place in a group.
std::vector<double> field_at(int place, std::size_t length) {
  std::vector<double> field(length);
  for (std::size_t i = 0; i < length; ++i) field[i] = 1000.0 * place + static_cast<double>(i);
  return field;
}

TEST(LayerGroupsTest, NeighbouringRanksAreAGroup) {
  for (const int count : group_counts()) {
    const LayerGroups groups(world, count);
    const int ranks = size_of(world) / count;
    EXPECT_EQ(groups.count(), count);
    EXPECT_EQ(groups.index(), rank_of(world) / ranks);
    EXPECT_EQ(size_of(groups.domain()), ranks);
    EXPECT_EQ(rank_of(groups.domain()), rank_of(world) % ranks);
    EXPECT_EQ(size_of(groups.across()), count);
    EXPECT_EQ(rank_of(groups.across()), groups.index());
  }
}

TEST(LayerGroupsTest, SharesOfAFieldMakeItUp) {
  for (const int count : group_counts()) {
    const LayerGroups groups(world, count);
    for (const std::size_t length : {0u, 1u, 2u, 13u}) {
      const std::vector<double> field = field_at(rank_of(groups.domain()), length);
      const std::vector<double> share = groups.share(field);
      EXPECT_LE(share.size(), length / count + 1);
      EXPECT_EQ(groups.gather(share), field);
    }
  }
}

TEST(LayerGroupsTest, SharesOutFieldsOfSingleGroups) {
  constexpr std::size_t length = 7;
  for (const int count : group_counts()) {
    const LayerGroups groups(world, count);
    std::vector<int> owners;
    std::vector<std::vector<double>> own, all;
    for (int row = 0; row < 9; ++row) {
      owners.push_back((row * row) % count);
      all.push_back(field_at(100 * row + rank_of(groups.domain()), length));
      if (owners.back() == groups.index()) own.push_back(all.back());
    }
    const auto shares = groups.share_out(own, owners, length);
    ASSERT_EQ(shares.size(), all.size());
    for (std::size_t row = 0; row < all.size(); ++row) EXPECT_EQ(shares[row], groups.share(all[row])) << row;
  }
}

TEST(LayerGroupsTest, SumsAndSends) {
  for (const int count : group_counts()) {
    const LayerGroups groups(world, count);
    const double place = rank_of(groups.domain());
    const auto value = [&](int group) { return 10.0 * group + place; };
    double total = 0.0;
    for (int group = 0; group < count; ++group) total += value(group);
    std::vector<double> values = {value(groups.index())};
    groups.sum(values);
    EXPECT_EQ(values[0], total);
    for (int owner = 0; owner < count; ++owner) {
      values = {value(groups.index())};
      groups.sum_at(owner, values);
      EXPECT_TRUE(owner != groups.index() || values[0] == total);
      values = {value(groups.index())};
      groups.broadcast(owner, values);
      EXPECT_EQ(values[0], value(owner));
    }
  }
}

/// What fails in one group is known to all; alone, an error stays what it was.
TEST(LayerGroupsTest, AFailureIsThrownInAllGroups) {
  for (const int count : group_counts())
    for (int failing = 0; failing < count; ++failing) {
      const LayerGroups groups(world, count);
      try {
        groups.run([&] {
          if (groups.index() == failing) throw NumericalError("group " + std::to_string(failing));
        });
        ADD_FAILURE() << "nothing thrown";
      } catch (const NumericalError& error) {
        EXPECT_EQ(std::string(error.what()), "group " + std::to_string(failing));
      }
    }
}

/// Values, displacement and gradients of a design, on the whole grid.
struct Results {
  std::vector<std::vector<double>> values;
  std::vector<double> displacement;
  std::vector<std::vector<double>> gradients;
  SolverIterations iterations;
};

/// Field and time points in one list.
template <int Dim>
std::vector<double> whole_gradient(const Setup<Dim>& setup, const Design& share) {
  const std::vector<double> field = setup.design_field(share.field);
  std::vector<double> result = setup.design_support.on_nodes()
                                   ? test::whole_node_field<Dim>(setup.grid, field)
                                   : test::whole_element_field<Dim>(setup.grid, field);
  result.insert(result.end(), share.layer_variables.begin(), share.layer_variables.end());
  return result;
}

template <int Dim>
Results evaluate(int groups, const Settings& settings) {
  Settings all = settings;
  all.emplace_back("solver.layer_groups", std::to_string(groups));
  test::PipelineCase<Dim> pipeline(all);
  const Setup<Dim>& setup = pipeline.setup;
  Design design = pipeline.wavy_point();
  design.field = setup.groups.share(design.field);
  Results results;
  for (int times = 0; times < 2; ++times) {  // the second time dealt out by the first one's iterations
    const auto state = pipeline.run(design);
    results.values = pipeline.pipeline.values(pipeline.problem.responses(), state);
    results.displacement = test::whole_node_field<Dim>(setup.grid, state.process->displacement, Dim);
    std::vector<GradientRow> rows;
    for (int r = 0; r < static_cast<int>(results.values.size()); ++r)
      for (int c = 0; c < static_cast<int>(results.values[r].size()); ++c) rows.push_back({{r, c, 1.0}});
    const int thickness = static_cast<int>(results.values.size()) - 2;
    rows.push_back(
        {{0, 0, 0.3}, {3, 0, -2.0}, {4, 0, 0.7}, {thickness, 1, 1.1}});  // with and without displacements
    results.gradients.clear();
    for (const Design& share : pipeline.pipeline.gradients(pipeline.problem.responses(), state, rows))
      results.gradients.push_back(whole_gradient(setup, share));
    results.iterations = pipeline.pipeline.iterations();
  }
  return results;
}

template <int Dim>
void expect_same(const Settings& settings, double tolerance) {
  const Results expected = evaluate<Dim>(1, settings);
  for (const int count : group_counts()) {
    if (count == 1 && size_of(world) > 1) continue;  // that is what is expected
    const Results actual = evaluate<Dim>(count, settings);
    EXPECT_LT(test::relative_difference(actual.displacement, expected.displacement), tolerance);
    ASSERT_EQ(actual.values.size(), expected.values.size());
    for (std::size_t r = 0; r < expected.values.size(); ++r)
      EXPECT_LT(test::relative_difference(actual.values[r], expected.values[r]), tolerance) << r;
    ASSERT_EQ(actual.gradients.size(), expected.gradients.size());
    for (std::size_t row = 0; row < expected.gradients.size(); ++row)
      EXPECT_LT(test::relative_difference(actual.gradients[row], expected.gradients[row]), tolerance) << row;
    EXPECT_EQ(actual.iterations.primal.size(), expected.iterations.primal.size());
    EXPECT_EQ(actual.iterations.adjoint.size(), expected.iterations.adjoint.size());
    EXPECT_EQ(actual.iterations.heat.size(), expected.iterations.heat.size());
    for (const auto* list : {&actual.iterations.primal, &actual.iterations.adjoint, &actual.iterations.heat})
      for (const int iterations : *list) EXPECT_GT(iterations, 0);
  }
}

template <class T>
class LayerGroupsPipelineTest : public testing::Test {};
TYPED_TEST_SUITE(LayerGroupsPipelineTest, test::Dimensions);

TYPED_TEST(LayerGroupsPipelineTest, GroupsChangeNothing) {
  // More layers than are solved side by side; fewer layers than groups.
  for (const char* layers : {"11", "2"}) expect_same<TypeParam::value>({{"layers.count", layers}}, 1e-9);
}

TYPED_TEST(LayerGroupsPipelineTest, GroupsChangeNothingAfterTheRelease) {
  using test::operator+;
  expect_same<TypeParam::value>(test::released_and_turning + test::on_clamped_substrate<TypeParam::value>() +
                                    Settings{{"layers.count", "9"}, {"solver.reference_method", "direct"}},
                                1e-8);
}

TYPED_TEST(LayerGroupsPipelineTest, GroupsChangeNothingOnTheReferencePath) {
  expect_same<TypeParam::value>({{"layers.count", "9"}, {"solver.path", "\"reference\""}}, 1e-9);
}

TYPED_TEST(LayerGroupsPipelineTest, GroupsChangeNothingInAQuietVoid) {
  expect_same<TypeParam::value>({{"process.void", "\"quiet\""}, {"sequence.filter_radius", "0.9"}}, 1e-9);
}

/// Time points get a part of their derivative from the layers of every group, and from responses.
TYPED_TEST(LayerGroupsPipelineTest, GroupsChangeNothingWithTimePointsAndTimesOfNodes) {
  const Settings variable = {{"layers.time_points", "variable"}, {"layers.count", "11"}};
  expect_same<TypeParam::value>(variable, 1e-9);
  Settings direct = variable;
  direct.insert(direct.begin(), {"sequence", R"({"type": "direct", "location": "nodes"})"});
  expect_same<TypeParam::value>(direct, 1e-9);
}

/// Increments of all layers can be had everywhere, and what counts of them sums up to the displacement.
TYPED_TEST(LayerGroupsPipelineTest, IncrementsAddUp) {
  constexpr int Dim = TypeParam::value;
  for (const int count : group_counts()) {
    test::PipelineCase<Dim> pipeline(
        Settings{{"layers.count", "11"}, {"solver.layer_groups", std::to_string(count)}});
    const auto state = pipeline.run(pipeline.setup.groups.share(pipeline.wavy_design()));
    std::vector<double> total(state.process->displacement.size(), 0.0);
    for (int layer = 0; layer < 11; ++layer) {
      const std::vector<double> increment = pipeline.pipeline.process().layer_increment(layer, true);
      ASSERT_EQ(increment.size(), total.size());
      for (std::size_t i = 0; i < total.size(); ++i) total[i] += increment[i];
    }
    for (std::size_t i = 0; i < total.size(); ++i)
      EXPECT_NEAR(total[i], state.process->displacement[i], 1e-14);
  }
}

TEST(LayerGroupsChoiceTest, RefusesGroupsThatDoNotDivideTheRanks) {
  const int ranks = size_of(world), refused = ranks + 1;
  try {
    const test::PipelineCase<2> pipeline(Settings{{"solver.layer_groups", std::to_string(refused)}});
    ADD_FAILURE() << "nothing thrown";
  } catch (const InputError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("/solver/layer_groups: found " + std::to_string(refused) + " on "),
              std::string::npos);
    EXPECT_NE(text.find("allowed: \"auto\" or a divisor"), std::string::npos) << text;
  }
}

TEST(LayerGroupsChoiceTest, ChoosesGroupsThatDivideTheRanksAndExplains) {
  for (const char* layers : {"1", "4", "40"}) {
    const test::PipelineCase<2> pipeline(
        Settings{{"layers.count", layers}, {"solver.layer_groups", "\"auto\""}});
    const GroupChoice& choice = pipeline.setup.group_choice;
    EXPECT_EQ(size_of(world) % choice.groups, 0);
    EXPECT_LE(choice.groups, std::atoi(layers));
    EXPECT_EQ(choice.explanation.empty(), size_of(world) == 1);
    if (size_of(world) == 1) continue;
    for (const char* word : {"(auto)", "memory estimate", "halo saved"})
      EXPECT_NE(choice.explanation.find(word), std::string::npos) << choice.explanation;
  }
}

}  // namespace
}  // namespace fabseq
