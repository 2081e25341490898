/// The table of config keys. Nothing about a key stands anywhere else but what relates it to other keys
/// (config_rules.cc).
#include "fabseq/io/schema.h"

namespace fabseq {

namespace {

using enum KeyType;

// clang-format off
constexpr ConfigSection sections_table[] = {
    {"", "Top level"},
    {"domain", "Box and grid; \"up\" is the last axis"},
    {"part", "The part: one shape or `voxels`, and"},
    {"part.voxels", "Part density from an HDF5 file with axes [z][y][x]"},
    {"shape", "Shapes, for `part`, `substrate`, `clamps`, node sets and `start`: an object with exactly one of"},
    {"shape.box", "Box along the axes"},
    {"shape.half_space", "Half space"},
    {"shape.cylinder", "Cylinder with flat ends"},
    {"shape.sphere", "Sphere, in two dimensions a disc"},
    {"shape.polygon", "Polygon, in three dimensions extruded through the box"},
    {"node_sets.NAME", "A named set of nodes: one shape, and"},
    {"material", "Material; displacements do not depend on Young's modulus"},
    {"process", "Process simulation"},
    {"sequence", "Fabrication sequence"},
    {"layers", "Layers"},
    {"projection", "Sharpness of the layers and its continuation"},
    {"objective", "Objective: a list of terms"},
    {"constraints", "Constraints: a list"},
    {"baseline", "Planar sequence the result is compared with"},
    {"optimizer", "Optimizer (method of moving asymptotes)"},
    {"optimizer.asymptotes", "Asymptotes"},
    {"solver", "Linear solver"},
    {"output", "Output"},
};

constexpr ConfigKey keys_table[] = {
    {.name = "name", .type = text, .default_value = "\"fabseq\"", .option = "-name", .meaning = "Name of the case; output goes to output/NAME unless -output says otherwise"},
    {.name = "domain", .type = section, .required = true, .meaning = "Box and grid"},
    {.name = "part", .type = part, .required = true, .meaning = "What is to be built: a shape, evaluated at element centres, or a voxel file"},
    {.name = "build_plate", .type = face, .default_value = "\"z-\"", .default_2d = "\"y-\"", .option = "-build_plate", .meaning = "Face of the box that is the build plate"},
    {.name = "substrate", .type = shape, .meaning = "What stands from the start, such as a base plate: elements whose centre is in the shape; they are no part"},
    {.name = "clamps", .type = shape, .meaning = "Nodes inside or on the shape are held in place of the plate's; with a substrate and without clamps: its lowest nodes along the plate's normal"},
    {.name = "node_sets", .type = node_sets, .default_value = "{}", .meaning = "Named sets of nodes for distortion terms: nodes inside or on a shape that touch the part or the substrate"},
    {.name = "material", .type = section, .default_value = "{}", .meaning = "Material"},
    {.name = "process", .type = section, .default_value = "{}", .meaning = "Process simulation"},
    {.name = "sequence", .type = section, .required = true, .meaning = "Fabrication sequence"},
    {.name = "layers", .type = section, .required = true, .meaning = "Layers"},
    {.name = "projection", .type = section, .default_value = "{}", .meaning = "Sharpness of the layers"},
    {.name = "objective", .type = sections, .required = true, .meaning = "Terms of the objective, summed with their weights"},
    {.name = "constraints", .type = sections, .default_value = "[]", .meaning = "Constraints"},
    {.name = "baseline", .type = section, .default_value = "{}", .meaning = "Planar sequence for comparison"},
    {.name = "optimizer", .type = section, .default_value = "{}", .meaning = "Optimizer"},
    {.name = "solver", .type = section, .default_value = "{}", .meaning = "Linear solver"},
    {.name = "output", .type = section, .default_value = "{}", .meaning = "Output"},

    {.section = "domain", .name = "size", .type = vector, .required = true, .range = "(0, inf)", .unit = "length", .option = "-size", .meaning = "Edge lengths of the box, which starts at the origin"},
    {.section = "domain", .name = "elements", .type = integer_vector, .required = true, .range = "[1, inf)", .option = "-elements", .meaning = "Elements along each axis; two entries: plane stress, three: solid"},
    {.section = "domain", .name = "thickness", .type = number, .default_value = "1.0", .range = "(0, inf)", .dimension = 2, .unit = "length", .meaning = "Thickness in plane stress"},

    {.section = "part", .name = "voxels", .type = section, .meaning = "In place of a shape: density from a file"},
    {.section = "part", .name = "stl", .type = unavailable, .meaning = "In place of a shape: surface from a file"},
    {.section = "part", .name = "keep", .type = choice, .default_value = "\"all\"", .words = "all connected", .meaning = "Pieces without a path of element faces to the plate are refused (all) or dropped with a warning (connected)"},
    {.section = "part.voxels", .name = "file", .type = path, .required = true, .meaning = "HDF5 file"},
    {.section = "part.voxels", .name = "dataset", .type = text, .default_value = "\"density\"", .meaning = "Dataset whose shape is domain.elements reversed"},
    {.section = "part.voxels", .name = "threshold", .type = number, .default_value = "\"none\"", .range = "(0, 1]", .words = "none", .meaning = "Densities from here on count as 1, others as 0; none: the grey density as it is"},

    {.section = "shape", .name = "box", .type = section, .meaning = "Box along the axes"},
    {.section = "shape", .name = "half_space", .type = section, .meaning = "(x - point) · normal <= 0"},
    {.section = "shape", .name = "cylinder", .type = section, .dimension = 3, .meaning = "Cylinder with flat ends"},
    {.section = "shape", .name = "sphere", .type = section, .meaning = "Sphere or disc"},
    {.section = "shape", .name = "polygon", .type = section, .meaning = "Polygon, even-odd rule"},
    {.section = "shape", .name = "union", .type = shapes, .meaning = "Points in at least one of the shapes"},
    {.section = "shape", .name = "intersection", .type = shapes, .meaning = "Points in all of the shapes"},
    {.section = "shape", .name = "difference", .type = shapes, .meaning = "Points in the first of the shapes and in none of the others"},
    {.section = "shape.box", .name = "min", .type = vector, .required = true, .unit = "length", .meaning = "Lower corner"},
    {.section = "shape.box", .name = "max", .type = vector, .required = true, .unit = "length", .meaning = "Upper corner"},
    {.section = "shape.half_space", .name = "point", .type = vector, .required = true, .unit = "length", .meaning = "Point on the plane"},
    {.section = "shape.half_space", .name = "normal", .type = vector, .required = true, .meaning = "Outward normal, of any length"},
    {.section = "shape.cylinder", .name = "from", .type = vector, .required = true, .unit = "length", .meaning = "Centre of one end"},
    {.section = "shape.cylinder", .name = "to", .type = vector, .required = true, .unit = "length", .meaning = "Centre of the other end"},
    {.section = "shape.cylinder", .name = "radius", .type = number, .required = true, .range = "(0, inf)", .unit = "length", .meaning = "Radius"},
    {.section = "shape.sphere", .name = "center", .type = vector, .required = true, .unit = "length", .meaning = "Centre"},
    {.section = "shape.sphere", .name = "radius", .type = number, .required = true, .range = "(0, inf)", .unit = "length", .meaning = "Radius"},
    {.section = "shape.polygon", .name = "points", .type = points, .required = true, .unit = "length", .meaning = "Corners, in three dimensions in the two other axes in ascending order"},
    {.section = "shape.polygon", .name = "axis", .type = axis, .required = true, .dimension = 3, .meaning = "Axis along which it is extruded"},

    {.section = "node_sets.NAME", .name = "samples", .type = integer, .default_value = "0", .range = "[0, inf)", .meaning = "Only so many nodes (at least 2), equally spaced along the longest edge of the set's bounding box; 0: all"},

    {.section = "material", .name = "young", .type = number, .default_value = "1.0", .range = "(0, inf)", .unit = "stress", .option = "-young", .meaning = "Young's modulus"},
    {.section = "material", .name = "poisson", .type = number, .default_value = "0.3", .range = "(-1, 0.5)", .option = "-poisson", .meaning = "Poisson's ratio"},
    {.section = "material", .name = "inherent_strain", .type = strain, .default_value = "[-0.01, -0.01, -0.01, 0, 0, 0]", .default_2d = "[-0.01, -0.01, 0]", .meaning = "Inherent strain: a Voigt vector, engineering shear, or values along and across the layers, with which it turns"},
    {.section = "material", .name = "strain_scale", .type = vector, .default_value = "[1, 1, 1]", .default_2d = "[1, 1]", .range = "[0, inf)", .meaning = "Factors on the inherent strain, axis by axis; shear by the root of the product of its two"},

    {.section = "process", .name = "stiffness_penalty", .type = number, .default_value = "3", .range = "[1, inf)", .meaning = "Exponent p of the stage density in the stiffness"},
    {.section = "process", .name = "strain_penalty", .type = number, .default_value = "3", .range = "[1, inf)", .meaning = "Exponent q of the layer density in the inherent strain; should not be below p"},
    {.section = "process", .name = "min_stiffness", .type = number, .default_value = "1e-9", .range = "(0, 1)", .meaning = "Stiffness of what is not built yet, relative to the material's"},
    {.section = "process", .name = "void", .type = choice, .default_value = "\"absent\"", .words = "absent quiet", .option = "-void", .meaning = "Elements outside the part are left out (absent) or carry the least stiffness (quiet)"},

    {.section = "sequence", .name = "type", .type = choice, .required = true, .words = "heat direct planar file", .meaning = "Where the pseudo-time of each element comes from"},
    {.section = "sequence", .variant = "heat", .name = "scale", .type = choice, .default_value = "\"log\"", .words = "log linear", .option = "-scale", .meaning = "Scale on which the optimizer moves the diffusivity"},
    {.section = "sequence", .variant = "heat", .name = "mass", .type = choice, .default_value = "\"auto\"", .words = "auto consistent lumped", .option = "-mass", .meaning = "Mass matrix of the drain; auto: lumped where the consistent one would leave the range of temperatures"},
    {.section = "sequence", .variant = "heat", .name = "initial", .type = number, .default_value = "\"distance\"", .range = "(0, inf)", .words = "distance", .meaning = "Initial diffusivity, uniform or from the distance to the plate inside the part"},
    {.section = "sequence", .variant = "heat", .name = "drain", .type = number, .default_value = "1.0", .range = "(0, inf)", .option = "-drain", .meaning = "Drain, divided by the square of the characteristic length"},
    {.section = "sequence", .variant = "heat", .name = "characteristic_length", .type = number, .default_value = "\"auto\"", .range = "(0, inf)", .words = "auto", .unit = "length", .option = "-characteristic_length", .meaning = "Length of the drain; auto: longest edge of the part's bounding box"},
    {.section = "sequence", .variant = "heat", .name = "bounds", .type = bounds, .default_value = "[1e-3, 1.0]", .range = "(0, inf)", .meaning = "Least and largest diffusivity in the part"},
    {.section = "sequence", .variant = "heat", .name = "void", .type = number, .default_value = "1e-3", .range = "(0, inf)", .meaning = "Diffusivity outside the part"},
    {.section = "sequence", .variant = "heat", .name = "filter_radius", .type = number, .default_value = "0.0", .range = "[0, inf)", .unit = "length", .option = "-filter_radius", .meaning = "Radius of the averaging filter on the diffusivity; 0: none"},
    {.section = "sequence", .variant = "direct", .name = "location", .type = choice, .default_value = "\"elements\"", .words = "elements nodes", .meaning = "Where the pseudo-time is a design variable; thickness and uniformity of layers need nodes"},
    {.section = "sequence", .variant = "direct", .name = "start", .type = shape, .default_value = "\"plate\"", .words = "plate", .meaning = "Where the pseudo-time is 0: elements by their centres or else by their nodes, or nodes; plate: what touches the build plate or the substrate"},
    {.section = "sequence", .variant = "planar", .name = "direction", .type = vector, .default_value = "\"auto\"", .words = "auto", .meaning = "Build direction, of any length; auto: the plate's normal"},
    {.section = "sequence", .variant = "file", .name = "file", .type = path, .required = true, .meaning = "HDF5 file with the pseudo-time of each element"},
    {.section = "sequence", .variant = "file", .name = "dataset", .type = text, .default_value = "\"time\"", .meaning = "Dataset with axes [z][y][x], values in [0, 1]"},

    {.section = "layers", .name = "type", .type = choice, .default_value = "\"curved\"", .words = "curved", .later = "multi_planar", .meaning = "Layers between isosurfaces of the pseudo-time (curved)"},
    {.section = "layers", .name = "count", .type = integer, .required = true, .range = "[1, 10000]", .words = "auto", .option = "-layers", .meaning = "Number of layers; auto: largest distance to the plate inside the part divided by the target thickness, rounded up"},
    {.section = "layers", .name = "time_points", .type = choice, .default_value = "\"uniform\"", .words = "uniform variable", .option = "-time_points", .meaning = "Pseudo-times at which layers end: equal steps, or design variables beside the sequence's"},

    {.section = "projection", .name = "beta", .type = number, .default_value = "\"auto\"", .range = "(0, inf)", .words = "auto", .option = "-beta", .meaning = "Sharpness at the start; auto: 4 times the number of layers"},
    {.section = "projection", .name = "factor", .type = number, .default_value = "1.5", .range = "[1, inf)", .option = "-beta_factor", .meaning = "Sharpness is multiplied by this at every step"},
    {.section = "projection", .name = "increment", .type = number, .default_value = "0", .range = "[0, inf)", .option = "-beta_increment", .meaning = "and this is added"},
    {.section = "projection", .name = "interval", .type = integer, .default_value = "15", .range = "[1, inf)", .unit = "iterations", .option = "-beta_interval", .meaning = "Iterations between two steps"},
    {.section = "projection", .name = "max", .type = number, .default_value = "\"auto\"", .range = "(0, inf)", .words = "auto", .option = "-beta_max", .meaning = "Sharpness at which the steps end; auto: 13.5 times the number of layers"},
    {.section = "projection", .name = "binary", .type = flag, .default_value = "false", .option = "-binary", .meaning = "Step function instead of a smooth one (no derivatives: for simulate and evaluate)"},

    {.section = "objective", .name = "type", .type = choice, .required = true, .words = "distortion layer_uniformity", .later = "segmentation_alignment", .meaning = "What is measured"},
    {.section = "objective", .variant = "distortion", .name = "measure", .type = choice, .default_value = "\"displacement\"", .words = "displacement flatness layerwise", .meaning = "Squared displacement over a node set, its flatness along an axis, or the squared displacement of every layer over all nodes"},
    {.section = "objective", .variant = "distortion", .name = "nodes", .type = text, .meaning = "Node set of displacement (required) and flatness (required)"},
    {.section = "objective", .variant = "distortion", .name = "axis", .type = axis, .meaning = "Axis of flatness (required)"},
    {.section = "objective", .variant = "distortion", .name = "mean", .type = flag, .default_value = "false", .meaning = "Divide displacement by the number of nodes"},
    {.section = "objective", .variant = "distortion", .name = "after_release", .type = flag, .default_value = "false", .meaning = "Measure displacement or flatness after the release from plate or clamps"},
    {.section = "objective", .variant = "layer_uniformity", .name = "form", .type = choice, .default_value = "\"sum_of_squares\"", .words = "sum_of_squares variance", .meaning = "Form of the deviation of the thickness within each layer"},
    {.section = "objective", .variant = "distortion", .name = "weight", .type = number, .default_value = "1.0", .range = "[0, inf)", .meaning = "Weight of the term"},
    {.section = "objective", .variant = "layer_uniformity", .name = "weight", .type = number, .default_value = "1.0", .range = "[0, inf)", .option = "-alpha", .meaning = "Weight of the term"},
    {.section = "objective", .name = "normalize", .type = number, .default_value = "100", .range = "(0, inf)", .meaning = "Value the term is scaled to"},
    {.section = "objective", .variant = "distortion", .name = "scaling", .type = choice, .default_value = "\"current\"", .words = "first current", .meaning = "Scaled at the first or at every iteration"},
    {.section = "objective", .variant = "layer_uniformity", .name = "scaling", .type = choice, .default_value = "\"first\"", .words = "first current", .meaning = "Scaled at the first or at every iteration"},
    {.section = "objective", .variant = "distortion", .name = "least_squares", .type = flag, .default_value = "false", .words = "auto", .meaning = "Hand displacement or flatness to the optimizer as a sum of squares, an elastic adjoint each; auto: with scaling current, while these hold most of it"},

    {.section = "constraints", .name = "type", .type = choice, .required = true, .words = "layer_thickness deposition_speed continuity minimum_layer_volume", .later = "subpart_volume", .meaning = "What is bounded"},
    {.section = "constraints", .variant = "layer_thickness", .name = "target", .type = number, .required = true, .range = "(0, inf)", .unit = "length", .option = "-target", .meaning = "Mean thickness of each layer"},
    {.section = "constraints", .variant = "layer_thickness", .name = "tolerance", .type = number, .default_value = "0.1", .range = "(0, 1)", .option = "-thickness_tolerance", .meaning = "Allowed deviation, relative to the target"},
    {.section = "constraints", .variant = "layer_thickness", .name = "least_volume", .type = number, .default_value = "0", .range = "[0, 1)", .option = "-least_volume", .meaning = "Layers with less volume, relative to the mean of all, fade out of the constraint; 0: all layers count, however small"},
    {.section = "constraints", .variant = "deposition_speed", .name = "slack", .type = number, .default_value = "1e-3", .range = "(0, 1)", .meaning = "By how much the built volume may lag behind, relative to the part's"},
    {.section = "constraints", .variant = "continuity", .name = "limit", .type = number, .default_value = "1e-3", .range = "(0, inf)", .meaning = "Largest mean square of the difference between the pseudo-time of an element and the mean of its neighbours"},
    {.section = "constraints", .variant = "minimum_layer_volume", .name = "fraction", .type = number, .default_value = "0.01", .range = "(0, 1)", .meaning = "Least volume of each layer, relative to the part's"},

    {.section = "baseline", .name = "layers", .type = integer, .default_value = "\"auto\"", .range = "[1, 10000]", .words = "auto", .option = "-baseline_layers", .meaning = "Number of planar layers; auto: height divided by the target thickness, else layers.count"},
    {.section = "baseline", .name = "direction", .type = vector, .default_value = "\"auto\"", .words = "auto", .meaning = "Build direction, of any length; auto: the plate's normal"},

    {.section = "optimizer", .name = "max_iterations", .type = integer, .default_value = "400", .range = "[1, inf)", .option = "-max_iterations", .meaning = "Iterations at most"},
    {.section = "optimizer", .name = "change_tolerance", .type = number, .default_value = "0.0", .range = "[0, inf)", .option = "-change_tolerance", .meaning = "Converged when no variable moves by as much, relative to its range, in `window` iterations at the last sharpness; 0: never"},
    {.section = "optimizer", .name = "objective_tolerance", .type = number, .default_value = "0.0", .range = "[0, inf)", .option = "-objective_tolerance", .meaning = "Converged when there is a feasible iterate and the objective varies by less, relative to what its terms are scaled to, in `window` iterations at the last sharpness; 0: never"},
    {.section = "optimizer", .name = "window", .type = integer, .default_value = "5", .range = "[1, 10000]", .unit = "iterations", .option = "-window", .meaning = "Iterations over which the two tolerances are looked at"},
    {.section = "optimizer", .name = "move_limit", .type = number, .default_value = "\"auto\"", .range = "(0, 1]", .words = "auto", .option = "-move_limit", .meaning = "Largest step of a variable, relative to its range; auto: 0.05 on the log, 0.2 on the linear scale, 0.02 for times (direct)"},
    {.section = "optimizer", .name = "final_move_limit", .type = number, .default_value = "\"auto\"", .range = "(0, 1]", .words = "auto", .option = "-final_move_limit", .meaning = "The same at the end of the run; auto: 0.004 on the log scale, else move_limit"},
    {.section = "optimizer", .name = "asymptotes", .type = section, .default_value = "{}", .meaning = "Asymptotes"},
    {.section = "optimizer", .name = "constraint_margin", .type = number, .default_value = "0.95", .range = "(0, 1]", .option = "-constraint_margin", .meaning = "Share of the constraints' tolerance handed to the optimizer"},
    {.section = "optimizer", .name = "coarse_iterations", .type = integer, .default_value = "0", .range = "[0, inf)", .later = "> 0", .meaning = "Iterations on a grid of half the resolution before the run proper"},
    {.section = "optimizer.asymptotes", .name = "initial", .type = number, .default_value = "0.5", .range = "(0, 10]", .meaning = "First distance, relative to the variable's range"},
    {.section = "optimizer.asymptotes", .name = "increase", .type = number, .default_value = "1.2", .range = "[1, inf)", .meaning = "Factor while a variable moves on in one direction"},
    {.section = "optimizer.asymptotes", .name = "decrease", .type = number, .default_value = "0.7", .range = "(0, 1]", .meaning = "Factor when a variable turns"},
    {.section = "optimizer.asymptotes", .name = "floor", .type = number, .default_value = "0.1", .range = "(0, 10]", .meaning = "Least distance, relative to the variable's range"},

    {.section = "solver", .name = "tolerance", .type = number, .default_value = "1e-6", .range = "(0, 1)", .option = "-tolerance", .meaning = "Preconditioned residual of every solve, relative to a zero start"},
    {.section = "solver", .name = "path", .type = choice, .default_value = "\"lanes\"", .words = "lanes reference", .option = "-solver_path", .meaning = "Solver: all layers of a batch at once (lanes), or PETSc's own parts, one layer at a time (reference)"},
    {.section = "solver", .name = "cycle", .type = choice, .default_value = "\"k\"", .words = "k w v", .option = "-solver_cycle", .meaning = "Multigrid cycle of the lanes: conjugate gradients on the coarse levels (k), several visits (w: fewer reductions, for many ranks) or one (v)"},
    {.section = "solver", .name = "smoother_degree", .type = integer, .default_value = "2", .range = "[1, 8]", .option = "-smoother_degree", .meaning = "Degree of the lanes' Chebyshev smoother, before and after"},
    {.section = "solver", .name = "reference_method", .type = choice, .default_value = "\"auto\"", .words = "auto gamg multigrid direct", .option = "-reference_method", .meaning = "Preconditioner of the reference path"},
    {.section = "solver", .name = "layer_groups", .type = integer, .default_value = "\"auto\"", .range = "[1, inf)", .words = "auto", .option = "-layer_groups", .meaning = "Groups of ranks that share the layers, each with the whole box; a divisor of the number of ranks; auto: by ranks, layers and memory"},
    {.section = "solver", .name = "lanes", .type = integer, .default_value = "\"auto\"", .range = "[1, 8]", .words = "auto", .option = "-lanes", .meaning = "Layers solved side by side at most. Fewer than 8 take less memory and more time; auto: 8, or as many as the memory holds"},

    {.section = "output", .name = "every", .type = integer, .default_value = "15", .range = "[0, inf)", .unit = "iterations", .option = "-output_every", .meaning = "Iterations between two dumps of the fields; 0: none"},
    {.section = "output", .name = "checkpoint_every", .type = integer, .default_value = "10", .range = "[0, inf)", .unit = "iterations", .option = "-checkpoint_every", .meaning = "Iterations between two checkpoints; 0: none"},
    {.section = "output", .name = "stages", .type = flag, .default_value = "false", .option = "-stages", .meaning = "Write the displacement after every layer"},
};
// clang-format on

}  // namespace

std::span<const ConfigKey> config_keys() { return keys_table; }
std::span<const ConfigSection> config_sections() { return sections_table; }

}  // namespace fabseq
