// SPDX-License-Identifier: MIT
#include "fabseq/config/config.h"

#include "fabseq/config/config_rules.h"
#include "fabseq/config/schema.h"

#include <algorithm>
#include <cmath>

namespace fabseq {

namespace {

/// None where a word ("auto") stands in place of the number.
std::optional<double> optional_number(const Json& value) {
  return value.is_number() ? std::optional<double>(value.get<double>()) : std::nullopt;
}

std::optional<int> optional_integer(const Json& value) {
  return value.is_number_integer() ? std::optional<int>(static_cast<int>(value.get<std::int64_t>()))
                                   : std::nullopt;
}

std::optional<bool> optional_boolean(const Json& value) {
  return value.is_boolean() ? std::optional<bool>(value.get<bool>()) : std::nullopt;
}

int integer(const Json& section, const char* key) {
  return static_cast<int>(section.at(key).get<std::int64_t>());
}

bool is(const Json& section, const char* key, const char* word) {
  return section.at(key).get<std::string>() == word;
}

std::vector<double> optional_vector(const Json& value) {
  return value.is_array() ? value.get<std::vector<double>>() : std::vector<double>{};
}

PartDescription make_part(const Json& value) {
  PartDescription part;
  part.keep_connected = is(value, "keep", "connected");
  part.sampling = integer(value, "sampling");
  if (const Json* voxels = find_member(value, "voxels")) {
    part.source = VoxelFile{voxels->at("file").get<std::string>(), voxels->at("dataset").get<std::string>(),
                            optional_number(voxels->at("threshold"))};
  } else {
    part.source = make_shape(value, "/part");
  }
  return part;
}

BuildPlate make_plate(const std::string& face) { return {face[0] - 'x', face[1] == '+'}; }

std::map<std::string, NodeSetDescription> make_node_sets(const Json& value) {
  std::map<std::string, NodeSetDescription> result;
  for (const auto& [name, member] : value) {
    result[name] = {make_shape(member, pointer_to("/node_sets", name)), integer(member, "samples"),
                    member.at("within").get<double>()};
  }
  return result;
}

/// The strain with strain_scale applied: shear by the root of the product of its two axes,
/// docs/formulation.md 4.5.
std::vector<double> scaled_strain(std::vector<double> strain, const std::vector<double>& scale) {
  const std::size_t dimension = scale.size();
  for (std::size_t axis = 0; axis < dimension; ++axis) strain[axis] *= scale[axis];
  for (std::size_t shear = dimension; shear < strain.size(); ++shear) {  // xy, yz, zx
    const std::size_t first = shear - dimension, second = first + 1 < dimension ? first + 1 : 0;
    strain[shear] *= std::sqrt(scale[first] * scale[second]);
  }
  return strain;
}

MaterialSettings make_material(const Json& value) {
  MaterialSettings material;
  material.young = value.at("young").get<double>();
  material.poisson = value.at("poisson").get<double>();
  material.strain_scale = value.at("strain_scale").get<std::vector<double>>();
  const Json& strain = value.at("inherent_strain");
  if (strain.is_object())
    material.turning_strain =
        TurningStrain{strain.at("tangential").get<double>(), strain.at("normal").get<double>()};
  else
    material.inherent_strain = scaled_strain(strain.get<std::vector<double>>(), material.strain_scale);
  return material;
}

ProcessSettings make_process(const Json& value) {
  ProcessSettings process;
  process.stiffness_penalty = value.at("stiffness_penalty").get<double>();
  process.strain_penalty = value.at("strain_penalty").get<double>();
  process.min_stiffness = value.at("min_stiffness").get<double>();
  process.void_model = is(value, "void", "quiet") ? VoidModel::quiet : VoidModel::absent;
  return process;
}

void read_heat(SequenceSettings& sequence, const Json& value) {
  sequence.scale = is(value, "scale", "log") ? VariableScale::log : VariableScale::linear;
  sequence.mass = is(value, "mass", "auto")         ? MassRule::automatic
                  : is(value, "mass", "consistent") ? MassRule::consistent
                                                    : MassRule::lumped;
  sequence.initial = optional_number(value.at("initial"));
  sequence.drain = value.at("drain").get<double>();
  sequence.characteristic_length = optional_number(value.at("characteristic_length"));
  sequence.min_diffusivity = value.at("bounds")[0].get<double>();
  sequence.max_diffusivity = value.at("bounds")[1].get<double>();
  sequence.void_diffusivity = value.at("void").get<double>();
  sequence.filter_radius = value.at("filter_radius").get<double>();
}

void read_direct(SequenceSettings& sequence, const Json& value) {
  sequence.scale = VariableScale::linear;
  sequence.filter_radius = value.at("filter_radius").get<double>();
  sequence.location = is(value, "location", "nodes") ? DesignLocation::nodes : DesignLocation::elements;
  if (value.at("start").is_object()) sequence.start = make_shape(value.at("start"), "/sequence/start");
}

SequenceSettings make_sequence(const Json& value) {
  SequenceSettings sequence;
  if (is(value, "type", "heat")) {
    sequence.type = SequenceType::heat;
    read_heat(sequence, value);
  } else if (is(value, "type", "direct")) {
    sequence.type = SequenceType::direct;
    read_direct(sequence, value);
  } else if (is(value, "type", "planar")) {
    sequence.type = SequenceType::planar;
    sequence.direction = optional_vector(value.at("direction"));
  } else {
    sequence.type = SequenceType::file;
    sequence.file = value.at("file").get<std::string>();
    sequence.dataset = value.at("dataset").get<std::string>();
  }
  return sequence;
}

ProjectionSettings make_projection(const Json& value) {
  ProjectionSettings projection;
  projection.beta = optional_number(value.at("beta"));
  projection.factor = value.at("factor").get<double>();
  projection.increment = value.at("increment").get<double>();
  projection.interval = integer(value, "interval");
  projection.max = optional_number(value.at("max"));
  projection.binary = value.at("binary").get<bool>();
  return projection;
}

ObjectiveTerm make_objective_term(const Json& value) {
  ObjectiveTerm term;
  term.type = value.at("type").get<std::string>();
  term.weight = value.at("weight").get<double>();
  term.normalize = value.at("normalize").get<double>();
  term.scaling = is(value, "scaling", "current") ? TermScaling::current : TermScaling::first;
  if (const Json* measure = find_member(value, "measure")) term.measure = measure->get<std::string>();
  if (const Json* nodes = find_member(value, "nodes")) term.nodes = nodes->get<std::string>();
  if (const Json* axis = find_member(value, "axis")) term.axis = axis->get<std::string>()[0] - 'x';
  if (const Json* mean = find_member(value, "mean")) term.mean = mean->get<bool>();
  if (const Json* after_release = find_member(value, "after_release"))
    term.after_release = after_release->get<bool>();
  if (const Json* squares = find_member(value, "least_squares"))
    term.least_squares = optional_boolean(*squares);
  if (const Json* form = find_member(value, "form")) term.form = form->get<std::string>();
  if (const Json* band = find_member(value, "band")) term.band = band->get<double>();
  return term;
}

ConstraintTerm make_constraint(const Json& value) {
  ConstraintTerm term;
  term.type = value.at("type").get<std::string>();
  if (const Json* target = find_member(value, "target")) term.target = target->get<double>();
  if (const Json* tolerance = find_member(value, "tolerance")) term.tolerance = tolerance->get<double>();
  if (const Json* volume = find_member(value, "least_volume")) term.least_volume = volume->get<double>();
  if (const Json* slack = find_member(value, "slack")) term.slack = slack->get<double>();
  if (const Json* limit = find_member(value, "limit")) term.limit = limit->get<double>();
  if (const Json* fraction = find_member(value, "fraction")) term.fraction = fraction->get<double>();
  return term;
}

/// Largest step where the config leaves it to us, docs/formulation.md 9: measured for diffusivities on the
/// log scale and for times, published for diffusivities themselves.
double automatic_move_limit(const SequenceSettings& sequence) {
  if (sequence.type == SequenceType::direct) return 0.02;
  return sequence.scale == VariableScale::log ? 0.05 : 0.2;
}

OptimizerSettings make_optimizer(const Json& value, const SequenceSettings& sequence) {
  OptimizerSettings optimizer;
  optimizer.max_iterations = integer(value, "max_iterations");
  optimizer.change_tolerance = value.at("change_tolerance").get<double>();
  optimizer.objective_tolerance = value.at("objective_tolerance").get<double>();
  optimizer.window = integer(value, "window");
  const bool log_scale = sequence.scale == VariableScale::log;
  optimizer.move_limit = optional_number(value.at("move_limit")).value_or(automatic_move_limit(sequence));
  const double final_limit = log_scale ? std::min(0.004, optimizer.move_limit) : optimizer.move_limit;
  optimizer.final_move_limit = optional_number(value.at("final_move_limit")).value_or(final_limit);
  const Json& asymptotes = value.at("asymptotes");
  optimizer.asymptote_initial = asymptotes.at("initial").get<double>();
  optimizer.asymptote_increase = asymptotes.at("increase").get<double>();
  optimizer.asymptote_decrease = asymptotes.at("decrease").get<double>();
  optimizer.asymptote_floor = asymptotes.at("floor").get<double>();
  optimizer.constraint_margin = value.at("constraint_margin").get<double>();
  optimizer.binary_iterations = integer(value, "binary_iterations");
  optimizer.coarse_iterations = integer(value, "coarse_iterations");
  optimizer.coarse_grids = integer(value, "coarse_grids");
  optimizer.earlier_iterations = integer(value, "earlier_iterations");
  optimizer.later_iterations = integer(value, "later_iterations");
  return optimizer;
}

SolverSettings make_solver(const Json& value) {
  SolverSettings solver;
  solver.tolerance = value.at("tolerance").get<double>();
  solver.path = is(value, "path", "lanes") ? SolverPath::lanes : SolverPath::reference;
  solver.cycle = is(value, "cycle", "v")   ? SolverCycle::v
                 : is(value, "cycle", "w") ? SolverCycle::w
                                           : SolverCycle::k;
  solver.smoother_degree = integer(value, "smoother_degree");
  solver.method = is(value, "reference_method", "gamg")        ? ReferenceMethod::gamg
                  : is(value, "reference_method", "multigrid") ? ReferenceMethod::multigrid
                  : is(value, "reference_method", "direct")    ? ReferenceMethod::direct
                                                               : ReferenceMethod::automatic;
  solver.layer_groups = optional_integer(value.at("layer_groups"));
  solver.lanes = optional_integer(value.at("lanes"));
  return solver;
}

OutputSettings make_output(const Json& value) {
  return {integer(value, "every"), integer(value, "checkpoint_every"), value.at("stages").get<bool>()};
}

void read_domain(Config& config, const Json& value) {
  config.size = value.at("size").get<std::vector<double>>();
  config.dimension = static_cast<int>(config.size.size());
  for (const Json& item : value.at("elements"))
    config.elements.push_back(static_cast<int>(item.get<std::int64_t>()));
  if (const Json* thickness = find_member(value, "thickness")) config.thickness = thickness->get<double>();
}

}  // namespace

std::optional<double> Config::target_thickness() const {
  for (const ConstraintTerm& term : constraints) {
    if (term.type == "layer_thickness") return term.target;
  }
  return std::nullopt;
}

bool Config::has_release() const {
  return std::any_of(objective.begin(), objective.end(),
                     [](const ObjectiveTerm& term) { return term.after_release; });
}

Config make_config(const Json& document, const std::string& directory) {
  Config config;
  config.effective = complete_config(document, directory);
  const Json& all = config.effective;
  config.name = all.at("name").get<std::string>();
  read_domain(config, all.at("domain"));
  config.part = make_part(all.at("part"));
  if (const Json* substrate = find_member(all, "substrate"))
    config.part.substrate = make_shape(*substrate, "/substrate");
  if (const Json* clamps = find_member(all, "clamps")) config.part.clamps = make_shape(*clamps, "/clamps");
  config.plate = make_plate(all.at("build_plate").get<std::string>());
  config.node_sets = make_node_sets(all.at("node_sets"));
  config.material = make_material(all.at("material"));
  config.process = make_process(all.at("process"));
  config.sequence = make_sequence(all.at("sequence"));
  config.layers = make_layer_settings(all.at("layers"), config.plate, config.dimension);
  config.projection = make_projection(all.at("projection"));
  for (const Json& term : all.at("objective")) config.objective.push_back(make_objective_term(term));
  for (const Json& term : all.at("constraints")) config.constraints.push_back(make_constraint(term));
  config.baseline.layers = optional_integer(all.at("baseline").at("layers"));
  config.baseline.direction = optional_vector(all.at("baseline").at("direction"));
  config.optimizer = make_optimizer(all.at("optimizer"), config.sequence);
  config.solver = make_solver(all.at("solver"));
  config.output = make_output(all.at("output"));
  check_rules(config);
  return config;
}

}  // namespace fabseq
