// SPDX-License-Identifier: MIT
/// \file
/// Measures of distortion for displacements that a test makes up.
#pragma once

#include "support/pipeline_case.h"
#include "support/response.h"

#include <memory>
#include <string>
#include <vector>

namespace fabseq::test {

/// Displacements are [owned node][component].
template <int Dim>
struct MeasureCase {
  explicit MeasureCase(const Settings& settings = {})
      : pipeline(settings), state(pipeline.run(pipeline.wavy_design())) {}

  /// `keys`: those of a distortion term beside its type.
  std::unique_ptr<Response<Dim>> make(const std::string& keys, TermList list = TermList::objective) const {
    return make_response<Dim>(list, R"({"type": "distortion", )" + keys + "}", pipeline.setup.context());
  }
  /// The values of a field(component, place) at the nodes.
  template <class Field>
  std::vector<double> displacement(const Field& field) const {
    const Grid<Dim>& grid = pipeline.setup.grid;
    std::vector<double> result;
    grid.owned_nodes().for_each([&](const Index<Dim>& index, std::int64_t) {
      for (int a = 0; a < Dim; ++a) result.push_back(field(a, grid.node_position(index)));
    });
    return result;
  }
  std::vector<double> rough_displacement(double size, int salt = 4) const {
    const Grid<Dim>& grid = pipeline.setup.grid;
    std::vector<double> result;
    grid.owned_nodes().for_each([&](const Index<Dim>& index, std::int64_t) {
      for (int a = 0; a < Dim; ++a)
        result.push_back(size * (noise(grid.all_nodes().offset(index), salt + a) - 0.4));
    });
    return result;
  }

  /// Collective, as is the next one.
  double value(const Response<Dim>& response, const std::vector<double>& displacement,
               const std::vector<double>& release = {}) const {
    const ProcessResult result = result_of(displacement, release);
    return response.values({state.time, state.densities, result}).at(0);
  }
  /// Derivatives with respect to the displacement and to that of the release.
  ProcessAdjoint derivative(const Response<Dim>& response, const std::vector<double>& displacement,
                            const std::vector<double>& release = {}) const {
    const ProcessResult result = result_of(displacement, release);
    StageDerivatives<Dim> adjoint(state.densities->count());
    response.add_derivative(0, 1.0, {state.time, state.densities, result}, adjoint);
    return std::move(adjoint.process);
  }
  /// The derivative in a direction less the central difference, relative to that.
  double error_of_derivative(const Response<Dim>& response, const std::vector<double>& displacement,
                             double step) const {
    const std::vector<double> direction = rough_displacement(1.0, 11);
    const double found = dot(derivative(response, displacement).displacement, direction);
    const double expected = (value(response, moved(displacement, step, direction)) -
                             value(response, moved(displacement, -step, direction))) /
                            (2.0 * step);
    return std::abs(found - expected) / std::abs(expected);
  }

  PipelineCase<Dim> pipeline;
  StageResults<Dim> state;

 private:
  static ProcessResult result_of(const std::vector<double>& displacement,
                                 const std::vector<double>& release) {
    ProcessResult result;
    result.displacement = displacement;
    result.release = release;
    return result;
  }
};

}  // namespace fabseq::test
