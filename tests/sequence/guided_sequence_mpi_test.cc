// SPDX-License-Identifier: MIT
/// The guided pseudo-time: planar layers, a dense matrix, differences, its start, and how often its operator
/// is set up (docs/formulation.md 2.4).
#include "sequence/guided_sequence.h"
#include "support/brute_force.h"
#include "support/heat_case.h"
#include "support/refusal.h"
#include "support/small_parts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

namespace fabseq {
namespace {

GuidedSettings settings_of(std::optional<std::array<double, 2>> stretch, double radius = 0.9) {
  GuidedSettings result;
  result.stretch = stretch;
  result.filter_radius = radius;
  result.characteristic_length = 1.7;
  result.void_diffusivity = 0.01;
  return result;
}

const std::array<double, 2> half_to_twice = {0.5, 2.0};

template <int Dim>
std::unique_ptr<GuidedProblem<Dim>> exact_problem(const Part<Dim>& part, const GuidedSettings& settings,
                                                  SolverPath path) {
  const auto make_solver = [&part, path](const SystemDomain& domain, bool lumped) {
    return test::exact_heat_solver<Dim>(part.grid(), domain, lumped, path);
  };
  return std::make_unique<GuidedProblem<Dim>>(part, settings.void_diffusivity, make_solver, MPI_COMM_SELF,
                                              widest_block);
}

template <int Dim>
GuidedSequence<Dim> exact_sequence(const Part<Dim>& part, const GuidedSettings& settings,
                                   SolverPath path = SolverPath::reference) {
  return {part, settings, exact_problem(part, settings, path)};
}

/// The gallows on a substrate.
template <int Dim>
PartDescription gallows_on_substrate() {
  PartDescription result{test::gallows<Dim>(), false};
  const auto size = test::odd_domain<Dim>().size;
  result.substrate = test::box(std::vector<double>(Dim, 0.0), {size.begin(), size.end()});
  result.substrate->second[Dim - 1] = 0.25 * size[Dim - 1];
  return result;
}

/// A design within bounds that depends on the places of the variables only, and a way through it.
template <int Dim>
std::vector<double> noise_of(const Part<Dim>& part, int components, double size, int salt) {
  std::vector<std::vector<double>> fields;
  for (int c = 0; c < components; ++c) fields.push_back(test::noise_field(part, -size, size, salt + 40 * c));
  std::vector<double> result;
  for (std::size_t e = 0; e < part.elements().size(); ++e)
    for (int c = 0; c < components; ++c) result.push_back(fields[c][e]);
  return result;
}

template <class T>
class GuidedSequenceTest : public testing::Test {};
TYPED_TEST_SUITE(GuidedSequenceTest, test::Dimensions);

/// a = 0, s = 0: the distance from the plate over the characteristic length, whichever face the plate is.
TYPED_TEST(GuidedSequenceTest, UprightDirectionsMakePlanarLayers) {
  constexpr int Dim = TypeParam::value;
  for (const BuildPlate plate :
       {BuildPlate{Dim - 1, false}, BuildPlate{Dim - 1, true}, BuildPlate{0, false}, BuildPlate{0, true}})
    for (const bool stretched : {false, true}) {
      const test::PartOnGrid<Dim> on_grid(test::odd_domain<Dim>(), test::block<Dim>(), plate);
      GuidedSettings settings = settings_of(stretched ? std::optional(half_to_twice) : std::nullopt);
      settings.start = GuidedStart::planar;
      auto sequence = exact_sequence<Dim>(on_grid.part, settings, SolverPath::lanes);
      const auto& time = sequence.update(sequence.initial_design());
      for (std::size_t e = 0; e < time.time.size(); ++e) {
        const Index<Dim> index = on_grid.grid.owned_elements().index(on_grid.part.elements()[e]);
        const double height = on_grid.grid.element_center(index)[plate.axis];
        const double from_plate = plate.upper ? on_grid.grid.domain().size[plate.axis] - height : height;
        EXPECT_NEAR(time.time[e], from_plate / 1.7, 1e-11);
        for (int axis = 0; axis < Dim; ++axis)
          EXPECT_NEAR(time.gradient[e * Dim + axis], plate.normal<Dim>()[axis] / 1.7, 1e-10);
      }
    }
}

/// Nodal times on the whole grid by a dense matrix; the filter and the directions have tests of their own.
template <int Dim>
std::vector<double> dense_times(const Part<Dim>& part, const GuidedSettings& settings,
                                const std::vector<double>& design) {
  const Grid<Dim>& grid = part.grid();
  constexpr int corners = corner_count<Dim>;
  const int components = settings.components(Dim);
  const AveragingFilter<Dim> filter(part, *settings.filter_radius);
  std::vector<std::vector<double>> guide, vectors(Dim, std::vector<double>(part.elements().size()));
  for (int c = 0; c < components; ++c) {
    std::vector<double> field;
    for (std::size_t e = 0; e < part.elements().size(); ++e) field.push_back(design[e * components + c]);
    guide.push_back(filter.apply(field));
  }
  for (std::size_t e = 0; e < part.elements().size(); ++e) {
    double square = 0.0;
    for (int i = 0; i < Dim - 1; ++i) square += guide[i][e] * guide[i][e];
    const double angle = std::sqrt(square);
    const double length = (settings.stretch ? std::exp(-guide[Dim - 1][e]) : 1.0) / 1.7;
    for (int i = 0; i < Dim - 1; ++i) vectors[i][e] = length * std::sin(angle) * guide[i][e] / angle;
    vectors[Dim - 1][e] = length * std::cos(angle);
  }
  for (auto& component : vectors) component = test::whole_part_field<Dim>(part, component);
  const auto inside = test::whole_part_field(part, std::vector<double>(part.elements().size(), 1.0));
  const auto standing = test::whole_element_field<Dim>(
      grid, std::vector<double>(part.substrate().elements().begin(), part.substrate().elements().end()));

  const test::BruteForceElement<Dim> element{grid.spacing(), grid.domain().thickness, 0.0};
  const auto conductivity =
      element.template matrix<corners>([&](int i, int j) { return element.conductivity(i, j); });
  test::DenseSystem<Dim> system(grid.domain().elements, 1);
  std::vector<double> load(system.size(), 0.0);
  grid.all_elements().for_each([&](const Index<Dim>& index, std::int64_t number) {
    const bool in_part = inside[number] > 0.0;
    system.add(index, conductivity, in_part ? 1.0 : settings.void_diffusivity);
    for (int i = 0; i < corners; ++i) {
      if (in_part)
        load[system.unknown(index, i)] += element.integrate([&](const auto& x) {
          double product = 0.0;
          for (int axis = 0; axis < Dim; ++axis) product += element.shape(i, x, axis) * vectors[axis][number];
          return product;
        });
      const bool on_plate = in_part && index[Dim - 1] == 0 && (i >> (Dim - 1)) == 0;
      if (on_plate || standing[number] != 0.0) system.fix(system.unknown(index, i));
    }
  });
  return system.solve(load);
}

TYPED_TEST(GuidedSequenceTest, AgreesWithADenseMatrix) {
  constexpr int Dim = TypeParam::value;
  for (const bool on_substrate : {false, true}) {
    const PartDescription description =
        on_substrate ? gallows_on_substrate<Dim>() : PartDescription{test::gallows<Dim>(), false};
    const test::PartOnGrid<Dim> on_grid(test::odd_domain<Dim>(), description);
    for (const bool stretched : {false, true}) {
      const GuidedSettings settings = settings_of(stretched ? std::optional(half_to_twice) : std::nullopt);
      const auto design = noise_of(on_grid.part, settings.components(Dim), 0.6, 1);
      const auto expected = dense_times(on_grid.part, settings, design);
      for (const SolverPath path : {SolverPath::reference, SolverPath::lanes}) {
        auto sequence = exact_sequence<Dim>(on_grid.part, settings, path);
        const PseudoTime<Dim>& time = sequence.update(design);
        EXPECT_LT(test::relative_difference(test::whole_node_field<Dim>(on_grid.grid, time.nodal), expected),
                  1e-9);
        EXPECT_GE(time.iterations.value(), 1);
      }
    }
  }
}

TYPED_TEST(GuidedSequenceTest, DerivativesAgreeWithDifferences) {
  constexpr int Dim = TypeParam::value;
  const test::PartOnGrid<Dim> on_grid(test::odd_domain<Dim>(), gallows_on_substrate<Dim>());
  const Part<Dim>& part = on_grid.part;
  const std::vector<TimeDerivatives> rows = test::time_functionals(part, 3);
  const auto value = [](const TimeDerivatives& row, const PseudoTime<Dim>& time) {
    return test::dot(row.time, time.time) + test::dot(row.gradient, time.gradient);
  };
  for (const bool stretched : {false, true})
    for (const double radius : {0.0, 0.9}) {
      const GuidedSettings settings =
          settings_of(stretched ? std::optional(half_to_twice) : std::nullopt, radius);
      auto sequence = exact_sequence<Dim>(part, settings);
      const auto design = noise_of(part, settings.components(Dim), 0.6, 1);
      const auto direction = noise_of(part, settings.components(Dim), 1.0, 5);
      (void)sequence.update(design);
      const auto gradients = sequence.pull_back(rows);
      EXPECT_EQ(sequence.adjoint_iterations().size(), rows.size());
      for (std::size_t row = 0; row < rows.size(); ++row) {
        const double expected = test::central_difference(
            [&](double step) {
              return value(rows[row], sequence.update(test::moved(design, step, direction)));
            },
            2e-2);
        EXPECT_NEAR(test::dot(gradients[row], direction), expected, 1e-6 * std::abs(expected))
            << row << ' ' << radius << ' ' << stretched;
      }
    }
}

/// Passes on to a solver, and counts.
template <int Dim>
class CountingSolver : public HeatSolver<Dim> {
 public:
  CountingSolver(std::unique_ptr<HeatSolver<Dim>> solver, int& operators)
      : solver_(std::move(solver)), operators_(operators) {}
  using HeatSolver<Dim>::set_operator;
  void set_operator(const HeatOperator& of) override {
    ++operators_;
    solver_->set_operator(of);
  }
  std::vector<SolveReport> solve(std::span<const LaneVector> loads,
                                 std::span<LaneVector> solutions) override {
    return solver_->solve(loads, solutions);
  }
  void set_tolerance(const SolveTolerance& tolerance) override { solver_->set_tolerance(tolerance); }
  void start_cold() override { solver_->start_cold(); }

 private:
  std::unique_ptr<HeatSolver<Dim>> solver_;
  int& operators_;
};

TYPED_TEST(GuidedSequenceTest, TheOperatorIsSetUpOnce) {
  constexpr int Dim = TypeParam::value;
  const test::PartOnGrid<Dim> on_grid(test::odd_domain<Dim>(), test::gallows<Dim>());
  const Part<Dim>& part = on_grid.part;
  const GuidedSettings settings = settings_of(half_to_twice);
  int operators = 0;
  const auto make_solver = [&](const SystemDomain& domain, bool lumped) {
    return std::make_unique<CountingSolver<Dim>>(
        test::exact_heat_solver<Dim>(part.grid(), domain, lumped, SolverPath::lanes), operators);
  };
  GuidedSequence<Dim> sequence(
      part, settings,
      std::make_unique<GuidedProblem<Dim>>(part, 0.01, make_solver, MPI_COMM_SELF, widest_block));
  const auto rows = test::time_functionals(part, 2);
  const auto design = noise_of(part, settings.components(Dim), 0.5, 1);
  const std::vector<double> first = sequence.update(design).nodal;
  const auto first_gradients = sequence.pull_back(rows);
  (void)sequence.update(noise_of(part, settings.components(Dim), 0.5, 2));
  (void)sequence.pull_back(rows);
  EXPECT_EQ(operators, 1);
  sequence.start_cold();
  EXPECT_EQ(sequence.update(design).nodal, first);
  EXPECT_EQ(sequence.pull_back(rows), first_gradients);
  EXPECT_EQ(operators, 2);
}

TYPED_TEST(GuidedSequenceTest, SpaceFollowsTheSettings) {
  constexpr int Dim = TypeParam::value;
  const test::PartOnGrid<Dim> on_grid(test::odd_domain<Dim>(), test::gallows<Dim>());
  GuidedSettings settings = settings_of(std::nullopt);
  settings.max_tilt = 45.0;
  EXPECT_EQ(exact_sequence<Dim>(on_grid.part, settings).space().count(), Dim - 1);
  settings.stretch = half_to_twice;
  const auto sequence = exact_sequence<Dim>(on_grid.part, settings);
  const DesignSpace space = sequence.space();
  ASSERT_EQ(space.count(), Dim);
  EXPECT_EQ(sequence.variables(), on_grid.part.elements().size() * Dim);
  for (int c = 0; c < Dim - 1; ++c) {
    EXPECT_DOUBLE_EQ(space.of(c).upper, 0.25 * std::numbers::pi);
    EXPECT_DOUBLE_EQ(space.of(c).lower, -0.25 * std::numbers::pi);
    EXPECT_FALSE(space.of(c).logarithmic);
  }
  EXPECT_DOUBLE_EQ(space.of(Dim - 1).lower, std::log(0.5));
  EXPECT_DOUBLE_EQ(space.of(Dim - 1).upper, std::log(2.0));
}

/// Along the arm of the gallows the distance grows sideways.
TYPED_TEST(GuidedSequenceTest, StartFollowsTheDistanceWithinTheTilt) {
  constexpr int Dim = TypeParam::value;
  const test::PartOnGrid<Dim> on_grid(test::odd_domain<Dim>(), test::gallows<Dim>());
  GuidedSettings settings = settings_of(half_to_twice);
  settings.max_tilt = 40.0;
  const double bound = settings.tilt_bound();
  const auto design = exact_sequence<Dim>(on_grid.part, settings).initial_design();
  double farthest = 0.0, upright = 1.0;
  for (std::size_t e = 0; e < on_grid.part.elements().size(); ++e) {
    double square = 0.0;
    for (int c = 0; c < Dim - 1; ++c) square += std::pow(design[e * Dim + c], 2);
    EXPECT_LE(std::sqrt(square), bound * (1.0 + 1e-12));
    EXPECT_EQ(design[e * Dim + Dim - 1], 0.0);
    farthest = std::max(farthest, design[e * Dim]);
    upright = std::min(upright, std::abs(design[e * Dim]));
  }
  EXPECT_GT(max(PETSC_COMM_WORLD, farthest), 0.9 * bound);
  EXPECT_LT(min(PETSC_COMM_WORLD, upright), 0.1 * bound);
}

TYPED_TEST(GuidedSequenceTest, StartTakesAVectorOfAnyLength) {
  constexpr int Dim = TypeParam::value;
  const test::PartOnGrid<Dim> on_grid(test::odd_domain<Dim>(), test::block<Dim>(), {0, true});
  GuidedSettings settings = settings_of(half_to_twice);
  settings.start = GuidedStart::direction;
  settings.direction.assign(Dim, 0.0);
  settings.direction[0] = -2.0;
  settings.direction[Dim - 1] = 2.0;
  settings.stretch = {{1.25, 2.0}};  // as of a tool that cannot deposit the target
  const auto design = exact_sequence<Dim>(on_grid.part, settings).initial_design();
  for (std::size_t e = 0; e < on_grid.part.elements().size(); ++e) {
    EXPECT_NEAR(design[e * Dim + Dim - 2], 0.25 * std::numbers::pi, 1e-14);
    EXPECT_DOUBLE_EQ(design[e * Dim + Dim - 1], std::log(1.25));
  }
}

}  // namespace
}  // namespace fabseq
