// SPDX-License-Identifier: MIT
/// What displacements and states of every step of plastic flow must satisfy (formulation 16): balance of
/// forces, flow rule, and balance of energies.
#include "support/flow_case.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace fabseq {
namespace {

using test::paired, test::SixNumbers;

/// What the process says of all elements and nodes of the grid behind a step.
struct Found {
  std::vector<double> increment, stress, plastic_strain;
};

/// Energies of a step of the backward Euler method. The stress at its end balances, so that it does no work
/// on the displacements of the step, whose strain is elastic, imposed and plastic:
///
///     sum V sigma : B du + h . du = 0,    B du = C^-1 (sigma - phi sigma')/E + l/E + dp,
///     stored + lost + dissipated = kept + work.
struct Energies {
  double stored = 0.0;      ///< elastic energy of the stress behind the step, 1/2 sigma : C^-1 sigma / E
  double kept = 0.0;        ///< the same of phi times the stress before it
  double lost = 0.0;        ///< the same of the difference of both; of second order in the step
  double dissipated = 0.0;  ///< sigma : dp = q dkappa = (Y + H kappa) dkappa
  double work = 0.0;        ///< of strains that are imposed, -sigma : l/E
};

class Balance {
 public:
  explicit Balance(const test::FlowCase& flow)
      : flow_(flow),
        element_(flow.process.grid().spacing(), flow.process.settings.material.poisson),
        system_(flow.process.grid().domain().elements, 3),
        held_(flow.held()),
        points_(flow.process.grid().all_elements().count()) {}

  /// Checks what the next step has led to; the last one is the release.
  Energies check(const Found& found) {
    const bool released = step_ == flow_.steps.size();
    const std::vector<test::FlowMaterial>& materials = flow_.materials[step_++];
    Energies result;
    std::vector<double> forces(found.increment.size(), 0.0);
    double largest_force = 0.0;
    flow_.process.grid().all_elements().for_each([&](const Index<3>& index, std::int64_t e) {
      if (materials[e].young == 0.0) return;
      test::FlowElement::Vector u;
      for (int i = 0; i < test::FlowElement::unknowns; ++i) u[i] = found.increment[system_.unknown(index, i)];
      State point = points_[e];
      std::copy_n(&found.stress[e * 6], 6, point.stress.begin());
      point.plastic_strain = found.plastic_strain[e];
      for (std::size_t i = 0; i < u.size(); ++i)
        point.amplitudes[i] = materials[e].ratio * point.amplitudes[i] + materials[e].young * u[i];
      const test::FlowElement::Vector hourglass = element_.hourglass_force(point.amplitudes);
      for (int i = 0; i < test::FlowElement::unknowns; ++i) {
        const double force = element_.volume * paired(element_.mean_strain[i], point.stress) + hourglass[i];
        forces[system_.unknown(index, i)] += force;
        largest_force = std::max(largest_force, std::abs(force));
      }
      expect_flow_rule(materials[e], points_[e], point, element_.mean(u));
      add(materials[e], points_[e], point, result);
      points_[e] = point;
    });
    for (std::size_t i = 0; i < forces.size(); ++i)
      EXPECT_TRUE(std::abs(forces[i]) < 1e-8 * largest_force || (!released && held_[i / 3] != 0))
          << forces[i];
    const double left = result.stored + result.lost + result.dissipated - result.kept - result.work;
    EXPECT_NEAR(left, 0.0, 1e-8 * result.stored);
    return result;
  }

 private:
  struct State {
    SixNumbers stress{};
    double plastic_strain = 0.0;
    test::FlowElement::Vector amplitudes{};  ///< displacements that lead to h with K_h
  };

  static SixNumbers change(const test::FlowMaterial& material, const State& before, const State& behind) {
    SixNumbers result;
    for (int c = 0; c < 6; ++c) result[c] = behind.stress[c] - material.ratio * before.stress[c];
    return result;
  }
  /// Looks at the plastic strain: what the step's strain is beyond the elastic and the imposed one.
  void expect_flow_rule(const test::FlowMaterial& material, const State& before, const State& behind,
                        const SixNumbers& strain) const {
    const double scale = *flow_.process.settings.material.yield_stress, tolerance = 1e-7 * scale,
                 flow = behind.plastic_strain - before.plastic_strain,
                 q = test::equivalent_stress(test::deviator(behind.stress)),
                 limit = material.yield + material.hardening * behind.plastic_strain;
    SixNumbers plastic = element_.strain(change(material, before, behind));  // times Young's modulus
    for (int c = 0; c < 6; ++c) plastic[c] = material.young * strain[c] - material.load[c] - plastic[c];
    EXPECT_NEAR(plastic[0] + plastic[1] + plastic[2], 0.0, tolerance);
    double square = 0.0;
    for (int c = 0; c < 6; ++c) square += (c < 3 ? 2.0 : 1.0) / 3.0 * plastic[c] * plastic[c];
    EXPECT_NEAR(std::sqrt(square), material.young * flow, tolerance);
    EXPECT_NEAR(paired(behind.stress, plastic), material.young * q * flow, tolerance * scale);
    EXPECT_GE(material.young * flow, -tolerance);
    EXPECT_LE(q, limit + tolerance);
    EXPECT_NEAR(material.young * flow * (q - limit), 0.0, tolerance * scale);
  }
  double energy(const test::FlowMaterial& material, const SixNumbers& stress,
                const test::FlowElement::Vector& amplitudes) const {
    const test::FlowElement::Vector forces = element_.hourglass_force(amplitudes);
    double result = element_.volume * paired(stress, element_.strain(stress));
    for (std::size_t i = 0; i < forces.size(); ++i) result += amplitudes[i] * forces[i];
    return 0.5 * result / material.young;
  }
  void add(const test::FlowMaterial& material, const State& before, const State& behind, Energies& to) const {
    State kept = before;
    for (double& value : kept.stress) value *= material.ratio;
    for (double& value : kept.amplitudes) value *= material.ratio;
    test::FlowElement::Vector difference;
    for (std::size_t i = 0; i < difference.size(); ++i)
      difference[i] = behind.amplitudes[i] - kept.amplitudes[i];
    to.stored += energy(material, behind.stress, behind.amplitudes);
    to.kept += energy(material, kept.stress, kept.amplitudes);
    to.lost += energy(material, change(material, before, behind), difference);
    to.dissipated += element_.volume * (behind.plastic_strain - before.plastic_strain) *
                     (material.yield + material.hardening * behind.plastic_strain);
    to.work -= element_.volume * paired(behind.stress, material.load) / material.young;
  }

  const test::FlowCase& flow_;
  test::FlowElement element_;
  test::DenseSystem<3> system_;
  std::vector<char> held_;
  std::vector<State> points_;
  std::size_t step_ = 0;
};

/// Simulates the first steps alone, one more each time: a process tells the states behind its last one.
void expect_balance(const test::FlowCase& flow) {
  const Grid<3>& grid = flow.process.grid();
  Balance balance(flow);
  const auto found = [&](const LockedIn& state, const std::vector<double>& increment) {
    return Found{flow.process.whole(increment), test::whole_element_field<3>(grid, state.stress, 6),
                 test::whole_element_field<3>(grid, state.plastic_strain)};
  };
  const auto held = test::plastic_process(flow.process, 1e-10, /*released=*/false);
  double dissipated = 0.0, work = 0.0;
  for (std::size_t count = 1; count <= flow.steps.size(); ++count) {
    (void)held->simulate(flow.input(count));
    const Energies energies =
        balance.check(found(held->locked_in(flow.layers), held->step_increment(static_cast<int>(count) - 1)));
    EXPECT_GT(energies.lost, 0.0);
    dissipated += energies.dissipated;
    work += energies.work;
  }
  EXPECT_GT(dissipated, 0.1 * work);
  const auto released = test::plastic_process(flow.process, 1e-10, /*released=*/true);
  const ProcessResult& result = released->simulate(flow.input(flow.steps.size()));
  const Energies energies = balance.check(
      found(released->released(released->locked_in(flow.layers), result.release), result.release));
  EXPECT_LT(energies.stored, energies.kept);
}

TEST(PlasticEnergyTest, AtOneTemperature) { expect_balance(test::FlowCase(test::flowing_case(), 4, 12.0)); }

TEST(PlasticEnergyTest, WithTemperatures) { expect_balance(test::FlowCase(test::heated_case(), 2, 12.0)); }

}  // namespace
}  // namespace fabseq
