/// \file
/// What a user asks for, typed: the result of reading and validating a config file (docs/users-guide.md, reference table).
#pragma once

#include "fabseq/grid/node_set.h"
#include "fabseq/grid/part.h"
#include "fabseq/grid/shape.h"
#include "fabseq/io/json.h"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace fabseq {

enum class Task { optimize, simulate, evaluate, check_gradients, check };

/// Inherent strain along and across the layers, docs/formulation.md 4.2.
struct TurningStrain {
  double tangential = 0.0, normal = 0.0;
};

struct MaterialSettings {
  double young = 1.0;  ///< stress unit
  double poisson = 0.3;
  /// Voigt order xx,yy,zz,xy,yz,zx (2D xx,yy,xy), engineering shear; strain_scale applied; empty where it turns
  std::vector<double> inherent_strain;
  std::optional<TurningStrain> turning_strain = std::nullopt;
  std::vector<double> strain_scale = {};  ///< a factor an axis, for strains that turn
};

enum class VoidModel { absent, quiet };

/// docs/formulation.md 4.1.
struct ProcessSettings {
  double stiffness_penalty = 3.0;
  double strain_penalty = 3.0;
  double min_stiffness = 1e-9;
  VoidModel void_model = VoidModel::absent;
};

enum class SequenceType { heat, direct, planar, file };
enum class DesignLocation { elements, nodes };
enum class VariableScale { log, linear };
enum class MassRule { automatic, consistent, lumped };

/// docs/formulation.md 2.1, 2.2 (heat), 2.3 (direct), 3.3 (planar), 3.1 (file).
struct SequenceSettings {
  SequenceType type = SequenceType::heat;
  VariableScale scale = VariableScale::log;
  MassRule mass = MassRule::automatic;
  std::optional<double> initial;  ///< uniform diffusivity; none: from the distance to the plate
  double drain = 1.0;
  std::optional<double>
      characteristic_length;  ///< length unit; none: longest edge of the part's bounding box
  double min_diffusivity = 1e-3, max_diffusivity = 1.0, void_diffusivity = 1e-3;
  double filter_radius = 0.0;                          ///< length unit; 0: no filter
  DesignLocation location = DesignLocation::elements;  ///< direct: where the pseudo-time lives
  std::optional<Shape> start;                          ///< direct: where it is 0; none: on the plate
  std::vector<double> direction;                       ///< planar: build direction; empty: the plate's normal
  std::string file;                                    ///< file: absolute path of an HDF5 file
  std::string dataset = "time";                        ///< file: its dataset, axes [z][y][x]
};

/// No part has as many layers; more are a slip, such as a target thickness in another unit.
constexpr int most_layers = 10000;

/// Sub-parts of planar layers, docs/formulation.md 3.2.
struct MultiPlanarSettings {
  int subparts = 1;                ///< N_P
  std::vector<double> timestamps;  ///< tau_1 ... tau_{N_P - 1}, ascending
  double thickness = 3.0;          ///< w, length unit
  /// To start from, and their bounds: [sub-part][angle], radians; 2D one angle, 3D elevation and azimuth.
  std::vector<double> angles, lowest_angles, highest_angles;
  double time_sharpness = 100.0, slab_sharpness = 100.0;  ///< k1, k2
  bool fixed_angles = false, fixed_time = false;          ///< kept from the optimizer
};

struct LayerSettings {
  std::optional<int> count;           ///< none: ceil(geodesic height / target thickness)
  bool variable_time_points = false;  ///< T_1 ... T_{N-1} are design variables
  std::optional<MultiPlanarSettings> multi_planar = std::nullopt;  ///< in place of curved layers
};

/// Sharpness beta of the layers and its continuation, docs/formulation.md 3.1.
struct ProjectionSettings {
  std::optional<double> beta;  ///< start; none: 4 N
  double factor = 1.5;
  double increment = 0.0;
  int interval = 15;          ///< iterations between two steps
  std::optional<double> max;  ///< none: 13.5 N
  bool binary = false;
};

enum class TermScaling { first, current };

struct ObjectiveTerm {
  std::string type;  ///< distortion, layer_uniformity, segmentation_alignment
  double weight = 1.0;
  double normalize = 100.0;
  TermScaling scaling = TermScaling::first;
  std::string measure;                ///< distortion: displacement, flatness, layerwise
  std::string nodes;                  ///< distortion: name of a node set
  int axis = -1;                      ///< flatness
  bool after_release = false;         ///< displacement, flatness: of the part cut from the plate
  bool mean = false;                  ///< displacement: divide by the number of nodes
  std::optional<bool> least_squares;  ///< displacement, flatness; none: where it pays
  std::string form;                   ///< layer_uniformity: sum_of_squares, variance
  double band = 0.1;                  ///< segmentation_alignment: width in pseudo-time

  /// Whether it may be handed over as a sum of squares, if its measure is one: "auto" leaves terms with the published
  /// scaling as published.
  bool may_be_squares() const { return least_squares.value_or(scaling == TermScaling::current); }
};

struct ConstraintTerm {
  std::string
      type;  ///< layer_thickness, deposition_speed, continuity, minimum_layer_volume, last_layer, subpart_volume
  double target = 0.0;     ///< layer_thickness, length unit
  double tolerance = 0.1;  ///< layer_thickness, subpart_volume, relative
  double least_volume =
      0.0;                 ///< layer_thickness, last_layer: of the mean volume; layers with less are slivers
  double slack = 1e-3;     ///< deposition_speed
  double limit = 1e-3;     ///< continuity
  double fraction = 0.01;  ///< minimum_layer_volume, of the part's
};

struct BaselineSettings {
  std::optional<int> layers;      ///< none: round(height / target), else the layer count
  std::vector<double> direction;  ///< empty: the plate's normal
};

struct OptimizerSettings {
  int max_iterations = 400;
  double change_tolerance = 0.0;
  double objective_tolerance = 0.0;
  int window = 5;  ///< iterations over which both are looked at
  double move_limit = 0.05,
         final_move_limit = 0.004;  ///< of the variable's range; "auto" already resolved by scale
  double asymptote_initial = 0.5, asymptote_increase = 1.2, asymptote_decrease = 0.7, asymptote_floor = 0.1;
  double constraint_margin = 0.95;
  int binary_iterations = 0;                         ///< the last ones, judged by binary layers
  int coarse_iterations = 0;                         ///< before the others, at half the resolution
  int coarse_grids = 1;                              ///< among which they are shared out
  int earlier_iterations = 0, later_iterations = 0;  ///< of other runs, in the schedules of this one
};

enum class SolverPath { lanes, reference };
enum class SolverCycle { v, w, k };
enum class ReferenceMethod { automatic, gamg, multigrid, direct };

struct SolverSettings {
  double tolerance = 1e-6;  ///< preconditioned residual, docs/formulation.md 4.1
  SolverPath path = SolverPath::lanes;
  SolverCycle cycle = SolverCycle::k;
  int smoother_degree = 2;
  ReferenceMethod method = ReferenceMethod::automatic;
  std::optional<int> layer_groups;  ///< none: by ranks, layers and memory
  std::optional<int> lanes;         ///< none: by memory
};

struct OutputSettings {
  int every = 15;
  int checkpoint_every = 10;
  bool stages = false;
};

/// A validated config. Vectors have `dimension` entries.
struct Config {
  std::string name;
  int dimension = 3;
  std::vector<double> size;
  std::vector<int> elements;
  double thickness = 1.0;
  PartDescription part;
  BuildPlate plate;
  std::map<std::string, NodeSetDescription> node_sets;
  MaterialSettings material;
  ProcessSettings process;
  SequenceSettings sequence;
  LayerSettings layers;
  ProjectionSettings projection;
  std::vector<ObjectiveTerm> objective;
  std::vector<ConstraintTerm> constraints;
  BaselineSettings baseline;
  OptimizerSettings optimizer;
  SolverSettings solver;
  OutputSettings output;

  Json
      effective;  ///< every key with its value, defaults filled in, paths absolute: runs again to the same result

  /// Whether |grad t| is defined, and with it whatever thickness means.
  bool has_time_gradient() const {
    return sequence.type != SequenceType::file &&
           !(sequence.type == SequenceType::direct && sequence.location == DesignLocation::elements);
  }
  /// Target thickness of the first layer_thickness constraint, if there is one.
  std::optional<double> target_thickness() const;
  /// Whether the sequence's field is kept from the optimizer.
  bool has_fixed_time() const { return layers.multi_planar && layers.multi_planar->fixed_time; }
  /// Whether a term measures after the release.
  bool has_release() const;
  template <int Dim>
  Domain<Dim> domain() const {
    Domain<Dim> result;
    for (int axis = 0; axis < Dim; ++axis) {
      result.size[axis] = size[axis];
      result.elements[axis] = elements[axis];
    }
    result.thickness = thickness;
    return result;
  }
};

/// Validates `document` (config text parsed, -set and flat options applied) against the table of keys and fills in
/// defaults. `directory`: absolute directory that relative paths in the config refer to. Not collective; the same on all
/// ranks. Throws InputError with the JSON pointer of the offending key, what was found and what is allowed.
Config make_config(const Json& document, const std::string& directory);

}  // namespace fabseq
