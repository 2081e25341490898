// SPDX-License-Identifier: MIT
#include "process/plastic_adjoint_history.h"

#include <algorithm>
#include <array>

namespace fabseq {

namespace {

constexpr int strain_count = ElementModes::strains;
constexpr int mode_count = ElementModes::components;
using Amplitudes = std::array<double, ElementModes::amplitudes>;

}  // namespace

/// A step of an element forward, and of its adjoint.
struct PlasticAdjointHistory::Record {
  PlasticStep step;
  PlasticReturn returned;
  std::array<double, mode_count> displacement{};  ///< increment
  PlasticPoint before;
  double plastic_strain = 0.0;  ///< after it
  // Adjoint.
  Voigt dual{};            ///< tau^
  Amplitudes hourglass{};  ///< eta
  double a = 0.0, c = 0.0;
  double d_ratio = 0.0;  ///< dJ/dphi
};

PlasticAdjointHistory::PlasticAdjointHistory(const PlasticHistory& history, const ElementModes& modes,
                                             const PlasticInput& input,
                                             const PlasticHistory::Displacements& displacements)
    : history_(history), modes_(modes), input_(input), displacements_(displacements) {}

/// Steps, and the release behind them.
void PlasticAdjointHistory::record(std::size_t e, std::vector<Record>& records) const {
  const std::size_t steps = input_.steps.size(), model_element = displacements_.first_element + e;
  const ElasticModel<3>& model = history_.model();
  PlasticPoint point = history_.start(input_, model_element);
  records.resize(steps + 1);
  for (std::size_t s = 0; s <= steps; ++s) {
    Record& own = records[s];
    own = {};
    if (s < steps) {
      history_.set_step(input_, model_element, s, own.step);
      const double* sums = &displacements_.steps[(e * steps + s) * mode_count];
      for (int c = 0; c < mode_count; ++c)
        own.displacement[c] = sums[c] - (displacements_.accumulated && s > 0 ? sums[c - mode_count] : 0.0);
    } else {
      own.step = records[steps - 1].step;
      own.step.load = 0.0;
      if (!displacements_.release.empty())
        std::copy_n(&displacements_.release[e * mode_count], mode_count, own.displacement.begin());
    }
    own.before = point;
    if (s == steps && displacements_.release.empty()) {
      own.returned.young = own.step.modulus * own.step.stiffness;
    } else {
      own.returned = advance(model.element, model.material.poisson, own.step, own.displacement.data(), point);
    }
    own.plastic_strain = point.plastic_strain;
  }
}

/// Adjoint displacement of a step less that of the next one.
std::array<double, mode_count> PlasticAdjointHistory::difference(const Adjoint& adjoint, std::size_t e,
                                                                 std::size_t s) const {
  const std::size_t steps = input_.steps.size();
  std::array<double, mode_count> result{};
  if (s < steps) {
    const double* own = &adjoint.steps[(e * steps + s) * mode_count];
    std::copy_n(own, mode_count, result.begin());
    for (int c = 0; !displacements_.accumulated && s + 1 < steps && c < mode_count; ++c)
      result[c] -= own[mode_count + c];
  } else if (!adjoint.release.empty()) {
    std::copy_n(&adjoint.release[e * mode_count], mode_count, result.begin());
  }
  return result;
}

/// Backwards (docs/developer/derivatives.md 16): mu is what the stress behind a step is worth, mu_kappa what its plastic strain is.
void PlasticAdjointHistory::run(const Adjoint& adjoint, std::vector<double>& forces,
                                std::vector<double>& at_release, PlasticDerivatives* derivatives) const {
  const std::size_t steps = input_.steps.size(), elements = adjoint.steps.size() / (steps * mode_count);
  forces.resize(adjoint.steps.size());
  at_release.resize(elements * mode_count);
  if (derivatives != nullptr) {
    for (auto* field : {&derivatives->stage, &derivatives->stage_before, &derivatives->layer,
                        &derivatives->modulus, &derivatives->yield, &derivatives->elongation})
      field->assign(elements * steps, 0.0);
    derivatives->strains.assign(elements * steps * strain_count, 0.0);
  }
  std::vector<Record> records;
  for (std::size_t e = 0; e < elements; ++e) {
    record(e, records);
    Voigt mu{};
    double mu_kappa = 0.0;
    Amplitudes eta{};
    std::array<double, mode_count> later{};
    for (std::size_t s = steps + 1; s-- > 0;) {
      Record& own = records[s];
      const std::array<double, mode_count> w = difference(adjoint, e, s);
      const double ratio_later = s < steps ? records[s + 1].returned.ratio : 0.0;
      for (int c = 0; c < strain_count; ++c) mu[c] += w[c];
      for (std::size_t k = 0; k < eta.size(); ++k) eta[k] = w[strain_count + k] + ratio_later * eta[k];
      Voigt dual = mu;
      if (own.returned.flow > 0.0) {
        const Voigt& n = own.returned.direction;
        const double r = own.returned.share, shear = own.returned.stress_of_shear;
        own.a = paired(mu, n);
        own.c = (mu_kappa - shear * own.a) / (shear + own.step.hardening);
        const Voigt d = deviator(mu);
        for (int c = 0; c < strain_count; ++c)
          dual[c] += 1.5 * (r * own.a + own.c) * (c < 3 ? 1.0 : 2.0) * n[c] - r * d[c];
        mu_kappa -= own.step.hardening * own.c;
      }
      own.dual = dual;
      own.hourglass = eta;
      own.d_ratio =
          modes_.volume() * paired(dual, own.before.stress) + modes_.energy(eta, own.before.hourglass);
      std::array<double, mode_count> force;
      const Voigt elastic = history_.model().element.stress(dual);
      for (int c = 0; c < strain_count; ++c) force[c] = own.returned.young * elastic[c];
      for (std::size_t k = 0; k < eta.size(); ++k) force[strain_count + k] = own.returned.young * eta[k];
      double* to = s < steps ? &forces[(e * steps + s) * mode_count] : &at_release[e * mode_count];
      for (int c = 0; c < mode_count; ++c)
        to[c] = force[c] - (displacements_.accumulated && s < steps ? later[c] : 0.0);
      later = force;
      for (int c = 0; c < strain_count; ++c) mu[c] = own.returned.ratio * dual[c];
    }
    for (std::size_t s = 0; derivatives != nullptr && s <= steps; ++s)
      add_derivatives(e, s, records, *derivatives);
  }
}

void PlasticAdjointHistory::add_derivatives(std::size_t e, std::size_t s, const std::vector<Record>& records,
                                            PlasticDerivatives& derivatives) const {
  const std::size_t steps = input_.steps.size(), at = e * steps + std::min(s, steps - 1);
  const Record& own = records[s];
  const ElasticModel<3>& model = history_.model();
  const double volume = modes_.volume();
  const auto density_of = [&](std::size_t number) {
    return model.stage_density(input_.densities.stage[input_.steps[number].layer],
                               displacements_.first_element + e);
  };
  Voigt strain, load = model.element.stress(own.dual);  // -dJ/dl
  std::copy_n(own.displacement.begin(), strain_count, strain.begin());
  Amplitudes amplitudes;
  std::copy_n(own.displacement.begin() + strain_count, amplitudes.size(), amplitudes.begin());
  double d_young = volume * paired(load, strain) + modes_.energy(own.hourglass, amplitudes);
  if (own.returned.flow > 0.0)
    d_young -= volume * 3.0 * own.returned.flow * (own.a + own.c) / (2.0 * (1.0 + model.material.poisson));
  for (double& value : load) value *= -volume;
  const double d_yield = -volume * own.c, d_hardening = -volume * own.c * own.plastic_strain;
  const double density = density_of(std::min(s, steps - 1));
  const double share = YieldShare::of(density), yield = history_.yield(), hardening = history_.hardening();
  const double yield_factor = yield > 0.0 ? own.step.yield / (share * yield) : 1.0;
  derivatives.stage[at] +=
      own.step.modulus * model.stiffness_derivative(density) * d_young +
      YieldShare::slope(density) * yield_factor * (yield * d_yield + hardening * d_hardening);
  derivatives.yield[at] += share * (yield * d_yield + hardening * d_hardening);
  derivatives.modulus[at] += own.step.stiffness * d_young + paired(load, own.returned.load) +
                             own.d_ratio / own.before.modulus;
  if (s < steps)
    derivatives.modulus[at] -= records[s + 1].d_ratio * records[s + 1].returned.ratio / own.step.modulus;
  const double normal = load[0] + load[1] + load[2];
  derivatives.elongation[at] += own.step.modulus * (own.step.load + own.before.stiffness) * normal;
  if (s == steps) return;
  derivatives.elongation[at] -= records[s + 1].step.modulus * own.step.stiffness * -volume * [&] {
    const Voigt next = model.element.stress(records[s + 1].dual);
    return next[0] + next[1] + next[2];
  }();
  if (s > 0)
    derivatives.stage_before[at] += own.step.modulus * model.stiffness_derivative(density_of(s - 1)) *
                                    (own.step.elongation - own.before.elongation) * normal;
  const int part_element = model.part_element[displacements_.first_element + e];
  if (!input_.steps[s].adds || part_element < 0) return;
  const double layer = input_.densities.layer[input_.steps[s].layer][part_element];
  derivatives.layer[at] +=
      model.load_derivative(layer) * own.step.modulus * paired(load, own.step.inherent_strain);
  for (int c = 0; c < strain_count; ++c)
    derivatives.strains[at * strain_count + c] += own.step.modulus * own.step.load * load[c];
}

}  // namespace fabseq
