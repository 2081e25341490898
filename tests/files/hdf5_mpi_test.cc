// SPDX-License-Identifier: MIT
#include "fabseq/base/hdf5.h"
#include "fabseq/files/hdf5_attribute.h"
#include "fabseq/files/hdf5_writer.h"
#include "support/io_support.h"

#include <cmath>
#include <limits>

namespace fabseq {
namespace {

using test::analytic_field;
using test::contains;
using test::error_text;
using test::is_first;

using Extents = std::vector<hsize_t>;

/// A dataset read whole by one rank, without what the library has for reading.
struct Dataset {
  Extents shape;
  bool single_precision = false;
  std::vector<double> values;
};

Dataset read(const std::string& path, const std::string& name) {
  Dataset result;
  const Hdf5File file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT));
  const Hdf5Dataset dataset(H5Dopen2(file, name.c_str(), H5P_DEFAULT));
  EXPECT_TRUE(dataset) << name;
  if (!dataset) return result;
  const Hdf5Dataspace space(H5Dget_space(dataset));
  result.shape.resize(static_cast<std::size_t>(H5Sget_simple_extent_ndims(space)));
  H5Sget_simple_extent_dims(space, result.shape.data(), nullptr);
  const Hdf5Datatype type(H5Dget_type(dataset));
  result.single_precision = H5Tequal(type, H5T_IEEE_F32LE) > 0;
  EXPECT_TRUE(result.single_precision || H5Tequal(type, H5T_IEEE_F64LE) > 0);
  result.values.resize(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
  EXPECT_GE(H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, result.values.data()), 0);
  return result;
}

std::vector<double> rounded(std::vector<double> values) {
  for (double& value : values) value = static_cast<float>(value);
  return values;
}

/// Extents of a box, slowest axis first, between `before` and `after`.
template <int Dim>
Extents extents(const IndexBox<Dim>& box, Extents before, const Extents& after) {
  before.insert(before.end(), box.size.rbegin(), box.size.rend());
  before.insert(before.end(), after.begin(), after.end());
  return before;
}

template <int Dim>
void expect_analytic_datasets() {
  const test::ScratchDirectory scratch;
  const std::string path = scratch.file("result.h5");
  const Grid<Dim> grid = test::odd_grid<Dim>();
  const std::vector<double> density = analytic_field<Dim>(grid.owned_elements(), 1);
  const std::vector<double> displacement = analytic_field<Dim>(grid.owned_nodes(), Dim);
  const std::vector<double> stress = analytic_field<Dim>(grid.owned_elements(), 6);
  const test::PartialField<Dim> partial(grid.owned_nodes(), Dim);
  FieldSet<Dim> set{&grid, {}};
  set.add_elements("density", density);
  set.add_nodes("a/b/displacement", displacement, Dim);
  set.add_elements("a/stress", stress, 6);
  set.fields.back().single_precision = true;
  set.add_nodes("partial", partial.values, Dim, &partial.places);

  Hdf5Writer writer(PETSC_COMM_WORLD, path);
  writer.write_fields(set);
  constexpr int stages = 3;
  for (int stage = 0; stage < stages; ++stage) {
    std::vector<double> values = displacement;
    for (double& value : values) value += 1e6 * stage;
    writer.write_stage<Dim>(grid, {"stages/displacement", true, Dim, values}, stage, stages);
  }
  writer.write_array("volumes", std::vector<double>{1.5, 2.5, 0.1});
  writer.write_array("empty", {});
  if (is_first()) {
    EXPECT_FALSE(std::filesystem::exists(path));
  }
  writer.close();
  if (!is_first()) return;

  const Dataset elements = read(path, "density");
  EXPECT_EQ(elements.shape, extents<Dim>(grid.all_elements(), {}, {}));
  EXPECT_EQ(elements.values, analytic_field<Dim>(grid.all_elements(), 1));
  const Dataset nodes = read(path, "a/b/displacement");
  const std::vector<double> all_displacements = analytic_field<Dim>(grid.all_nodes(), Dim);
  EXPECT_EQ(nodes.shape, extents<Dim>(grid.all_nodes(), {}, {Dim}));
  EXPECT_EQ(nodes.values, all_displacements);
  EXPECT_EQ(read(path, "partial").values, test::PartialField<Dim>(grid.all_nodes(), Dim).whole);
  const Dataset floats = read(path, "a/stress");
  EXPECT_TRUE(floats.single_precision);
  EXPECT_EQ(floats.shape, extents<Dim>(grid.all_elements(), {}, {6}));
  EXPECT_EQ(floats.values, rounded(analytic_field<Dim>(grid.all_elements(), 6)));
  const Dataset staged = read(path, "stages/displacement");
  EXPECT_TRUE(staged.single_precision);
  EXPECT_EQ(staged.shape, extents<Dim>(grid.all_nodes(), {stages}, {Dim}));
  std::vector<double> expected;
  for (int stage = 0; stage < stages; ++stage)
    for (const double value : all_displacements) expected.push_back(static_cast<float>(value + 1e6 * stage));
  EXPECT_EQ(staged.values, expected);
  EXPECT_EQ(read(path, "volumes").values, (std::vector<double>{1.5, 2.5, 0.1}));
  EXPECT_EQ(read(path, "empty").shape, Extents{0});
  EXPECT_FALSE(std::filesystem::exists(path + ".partial"));
}

TEST(Hdf5Writer, DatasetsDoNotDependOnTheRanks3D) { expect_analytic_datasets<3>(); }
TEST(Hdf5Writer, DatasetsDoNotDependOnTheRanks2D) { expect_analytic_datasets<2>(); }

/// Every third node of the grid: its numbers, whoever owns it.
template <int Dim>
void expect_node_numbers() {
  const test::ScratchDirectory scratch;
  const std::string path = scratch.file("result.h5");
  const Grid<Dim> grid = test::odd_grid<Dim>();
  std::vector<int> places;
  grid.owned_nodes().for_each([&](const Index<Dim>& node, std::int64_t offset) {
    if (grid.all_nodes().offset(node) % 3 == 0) places.push_back(static_cast<int>(offset));
  });
  Hdf5Writer writer(PETSC_COMM_WORLD, path);
  writer.write_node_numbers<Dim>(grid, "sets/third", places);
  writer.write_node_numbers<Dim>(grid, "sets/none", {});
  writer.close();
  if (!is_first()) return;
  const Hdf5File file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT));
  const Hdf5Dataset dataset(H5Dopen2(file, "sets/third", H5P_DEFAULT));
  ASSERT_TRUE(dataset);
  const Hdf5Datatype type(H5Dget_type(dataset));
  EXPECT_GT(H5Tequal(type, H5T_STD_I64LE), 0);
  EXPECT_TRUE(read_attribute(dataset, "checksum"));
  const Hdf5Dataspace space(H5Dget_space(dataset));
  std::vector<std::int64_t> found(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space))), expected;
  EXPECT_GE(H5Dread(dataset, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, found.data()), 0);
  for (std::int64_t node = 0; node < grid.all_nodes().count(); node += 3) expected.push_back(node);
  EXPECT_EQ(found, expected);
  const Hdf5Dataset none(H5Dopen2(file, "sets/none", H5P_DEFAULT));
  const Hdf5Dataspace empty(H5Dget_space(none));
  EXPECT_EQ(H5Sget_simple_extent_npoints(empty), 0);
}

TEST(Hdf5Writer, NodeNumbersDoNotDependOnTheRanks3D) { expect_node_numbers<3>(); }
TEST(Hdf5Writer, NodeNumbersDoNotDependOnTheRanks2D) { expect_node_numbers<2>(); }

TEST(Hdf5Writer, AttributesKeepTypeAndEveryBit) {
  const test::ScratchDirectory scratch;
  const double third = 1.0 / 3.0, nan = std::numeric_limits<double>::quiet_NaN();
  const std::int64_t large = (std::int64_t{1} << 53) + 1;
  Hdf5Writer writer(PETSC_COMM_WORLD, scratch.file("a.h5"));
  writer.write_attribute("iteration", large);
  writer.write_attribute("beta", 1.0);
  writer.write_attribute("beta", third);  // the last one counts
  writer.write_attribute("worst", nan);
  writer.write_attribute("status", "größer");
  writer.write_attribute("empty", "");
  writer.write_attribute("converged", true);
  writer.write_attribute("failed", false);
  error_text<OutputError>([&] { writer.write_attribute("list", Json::array()); });
  writer.close();
  if (!is_first()) return;
  const Hdf5File file(H5Fopen(scratch.file("a.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT));
  EXPECT_EQ(attribute_names(file), (std::vector<std::string>{"beta", "converged", "empty", "failed",
                                                             "iteration", "status", "worst"}));
  EXPECT_EQ(read_attribute(file, "iteration").value().get<std::int64_t>(), large);
  EXPECT_EQ(read_attribute(file, "beta").value().get<double>(), third);
  EXPECT_TRUE(std::isnan(read_attribute(file, "worst").value().get<double>()));
  EXPECT_EQ(read_attribute(file, "status").value().get<std::string>(), "größer");
  EXPECT_EQ(read_attribute(file, "empty").value().get<std::string>(), "");
  EXPECT_TRUE(read_attribute(file, "converged").value().get<bool>());
  EXPECT_FALSE(read_attribute(file, "failed").value().get<bool>());
  EXPECT_FALSE(read_attribute(file, "missing"));
}

TEST(Hdf5Writer, LeavesTheOldFileAndNoRestUnlessClosed) {
  const test::ScratchDirectory scratch;
  const std::string path = scratch.file("a.h5");
  for (const double value : {1.0, 2.0}) {
    Hdf5Writer writer(PETSC_COMM_WORLD, path);
    writer.write_array("x", std::vector<double>{value});
    if (value == 1.0) writer.close();
  }
  if (!is_first()) return;
  EXPECT_EQ(read(path, "x").values, std::vector<double>{1.0});
  EXPECT_FALSE(std::filesystem::exists(path + ".partial"));
}

TEST(Hdf5Writer, FailsOnAllRanksWithoutADirectory) {
  const test::ScratchDirectory scratch;
  const std::string path = scratch.file("missing/a.h5");
  const std::string text = error_text<OutputError>([&] { Hdf5Writer(PETSC_COMM_WORLD, path); });
  EXPECT_TRUE(contains(text, path)) << text;
}

/// A grid whose fields have 24,000 elements: 192,000 bytes in double precision.
Grid<3> full_disk_grid() {
  Domain<3> domain;
  domain.size = {1.0, 1.0, 1.0};
  domain.elements = {40, 20, 30};
  return Grid<3>(PETSC_COMM_WORLD, domain, {});
}

TEST(Hdf5Writer, NoticesAFullDiskAndGivesTheSpaceBack) {
  const test::SmallDisk disk("300k");
  if (!disk.mounted()) GTEST_SKIP() << "needs the privilege to mount a tmpfs";
  const Grid<3> grid = full_disk_grid();
  const std::vector<double> values = analytic_field<3>(grid.owned_elements(), 1);
  for (int trial = 0; trial < 2; ++trial) {
    Hdf5Writer writer(PETSC_COMM_WORLD, disk.file("a.h5"));
    writer.write_field<3>(grid, {"first", false, 1, values});
    const std::string text = error_text<OutputError>([&] {
      writer.write_field<3>(grid, {"second", false, 1, values});
    });
    EXPECT_TRUE(contains(text, disk.file("a.h5"))) << text;
  }
  MPI_Barrier(PETSC_COMM_WORLD);
  EXPECT_TRUE(std::filesystem::is_empty(disk.path()));
  EXPECT_EQ(disk.used(), 0u);  // not even a deleted file that is still open
  MPI_Barrier(PETSC_COMM_WORLD);
  Hdf5Writer writer(PETSC_COMM_WORLD, disk.file("a.h5"));
  writer.write_field<3>(grid, {"first", false, 1, values});
  EXPECT_NO_THROW(writer.close());
}

TEST(Hdf5Writer, NoticesADiskThatIsFullOnlyAtTheEnd) {
  const test::SmallDisk disk("300k");
  if (!disk.mounted()) GTEST_SKIP() << "needs the privilege to mount a tmpfs";
  // What close() flushes, attributes and the like, finds no room.
  Hdf5Writer writer(PETSC_COMM_WORLD, disk.file("a.h5"));
  for (int i = 0; i < 20; ++i) writer.write_attribute("a" + std::to_string(i), std::string(1000, 'x'));
  if (is_first()) {
    std::ofstream filler(disk.file("filler"));
    filler << std::string(400000, 'x');
  }
  MPI_Barrier(PETSC_COMM_WORLD);
  const std::string text = error_text<OutputError>([&] { writer.close(); });
  EXPECT_TRUE(contains(text, disk.file("a.h5"))) << text;
}

TEST(Hdf5Writer, NoticesAFullDiskWhereverItHappens) {
  const Grid<3> grid = test::odd_grid<3>();
  const std::vector<double> values = analytic_field<3>(grid.owned_nodes(), 3);
  bool fits = false;
  int failures = 0;
  for (int kilobytes = 4; !fits && kilobytes <= 200; kilobytes += 4) {
    const test::SmallDisk disk(std::to_string(kilobytes) + "k");
    if (!disk.mounted()) GTEST_SKIP() << "needs the privilege to mount a tmpfs";
    try {
      Hdf5Writer writer(PETSC_COMM_WORLD, disk.file("a.h5"));
      for (const char* name : {"a", "group/b", "group/below/c"})
        writer.write_field<3>(grid, {name, true, 3, values});
      for (int stage = 0; stage < 2; ++stage)
        writer.write_stage<3>(grid, {"stages", true, 3, values}, stage, 2);
      writer.write_attribute("text", std::string(5000, 'x'));
      writer.close();
      fits = true;
    } catch (const OutputError& error) {
      EXPECT_TRUE(contains(error.what(), disk.file("a.h5"))) << error.what();
      ++failures;
    }
    MPI_Barrier(PETSC_COMM_WORLD);
    if (!fits) {
      EXPECT_EQ(disk.used(), 0u) << kilobytes;
    } else if (is_first()) {
      EXPECT_EQ(read(disk.file("a.h5"), "group/below/c").values, analytic_field<3>(grid.all_nodes(), 3));
    }
  }
  EXPECT_TRUE(fits);
  EXPECT_GE(failures, 5);
}

template <int Dim>
void expect_round_trip() {
  const test::ScratchDirectory scratch;
  const Grid<Dim> grid = test::odd_grid<Dim>();
  const std::vector<double> values = analytic_field<Dim>(grid.owned_elements(), 1);
  Hdf5Writer writer(PETSC_COMM_WORLD, scratch.file("a.h5"));
  writer.write_field<Dim>(grid, {"group/design", false, 1, values});
  writer.close();
  EXPECT_EQ(read_field(grid, false, scratch.file("a.h5"), "group/design"), values);
}

TEST(ReadElementField, ReturnsWhatWasWritten3D) { expect_round_trip<3>(); }
TEST(ReadElementField, ReturnsWhatWasWritten2D) { expect_round_trip<2>(); }

TEST(ReadElementField, SaysWhatIsWrongOnAllRanks) {
  const test::ScratchDirectory scratch;
  const Grid<3> grid = test::odd_grid<3>();
  const std::vector<double> vectors = analytic_field<3>(grid.owned_elements(), 3);
  const std::vector<double> nodes = analytic_field<3>(grid.owned_nodes(), 1);
  const std::string path = scratch.file("a.h5");
  Hdf5Writer writer(PETSC_COMM_WORLD, path);
  writer.write_field<3>(grid, {"vectors", false, 3, vectors});
  writer.write_field<3>(grid, {"nodes", true, 1, nodes});
  writer.close();
  if (is_first()) {
    std::ofstream(scratch.file("text.h5")) << "no HDF5";
    std::filesystem::copy_file(path, scratch.file("cut.h5"));
    std::filesystem::resize_file(scratch.file("cut.h5"), std::filesystem::file_size(path) / 2);
  }
  MPI_Barrier(PETSC_COMM_WORLD);
  const auto text_of = [&](const std::string& file, const std::string& dataset) {
    return error_text<InputError>(
        [&] { read_field(grid, false, scratch.file(file), dataset, "-design", "/x"); });
  };
  for (const char* file : {"missing.h5", "text.h5", "cut.h5", "."}) {
    const std::string text = text_of(file, "vectors");
    EXPECT_TRUE(contains(text, "-design") && contains(text, scratch.file(file))) << text;
  }
  for (const char* dataset : {"missing", "vectors", "nodes", ""}) {
    const std::string text = text_of("a.h5", dataset);
    EXPECT_TRUE(contains(text, "/x") && contains(text, path) && contains(text, dataset)) << text;
  }
  EXPECT_TRUE(contains(text_of("a.h5", "nodes"), "[6,4,8], needs [5,3,7]")) << text_of("a.h5", "nodes");
}

}  // namespace
}  // namespace fabseq
