// SPDX-License-Identifier: MIT
#include "fabseq/files/field_dump.h"
#include "fabseq/files/hdf5_writer.h"
#include "fabseq/files/output_directory.h"
#include "support/io_support.h"

#include <cstring>
#include <optional>
#include <sys/wait.h>

namespace fabseq {
namespace {

using test::analytic_field;
using test::contains;
using test::error_text;
using test::file_text;
using test::is_first;

/// Element and node fields with one and several components, one of them in single precision.
template <int Dim>
struct SampleFields {
  explicit SampleFields(const Grid<Dim>& grid) {
    set.grid = &grid;
    for (const bool on_nodes : {false, true})
      for (const int components : {1, Dim, 6})
        values.push_back(
            analytic_field<Dim>(on_nodes ? grid.owned_nodes() : grid.owned_elements(), components));
    partial.emplace(grid.owned_elements(), Dim);
    set.add_elements("density", values[0]);
    set.add_nodes("displacement", values[4], Dim);
    set.add_elements("stress", values[2], 6);
    set.add_elements("direction", values[1], Dim);
    set.add_nodes("temperature", values[3]);
    set.fields.back().single_precision = true;
    set.add_elements("partial", partial->values, Dim, &partial->places);
  }
  FieldSet<Dim> set;
  std::optional<test::PartialField<Dim>> partial;
  std::vector<std::vector<double>> values;
};

template <class Value>
void append(std::string& bytes, const std::vector<double>& values) {
  for (const double value : values) {
    const auto stored = static_cast<Value>(value);
    char text[sizeof stored];
    std::memcpy(text, &stored, sizeof stored);
    bytes.append(text, sizeof stored);
  }
}

template <int Dim>
std::string expected_bytes(const Grid<Dim>& grid) {
  std::string bytes;
  append<double>(bytes, analytic_field<Dim>(grid.all_elements(), 1));
  append<double>(bytes, analytic_field<Dim>(grid.all_nodes(), Dim));
  append<double>(bytes, analytic_field<Dim>(grid.all_elements(), 6));
  append<double>(bytes, analytic_field<Dim>(grid.all_elements(), Dim));
  append<float>(bytes, analytic_field<Dim>(grid.all_nodes(), 1));
  append<double>(bytes, test::PartialField<Dim>(grid.all_elements(), Dim).whole);
  return bytes;
}

template <int Dim>
void expect_analytic_bytes() {
  const test::ScratchDirectory scratch;
  const Grid<Dim> grid = test::odd_grid<Dim>();
  const SampleFields<Dim> sample(grid);
  if (is_first())
    std::ofstream(scratch.file("dump.bin")) << std::string(100000, 'x');  // longer than the dump
  MPI_Barrier(PETSC_COMM_WORLD);
  write_field_dump(PETSC_COMM_WORLD, sample.set, scratch.file("dump"));
  if (!is_first()) return;
  EXPECT_EQ(file_text(scratch.file("dump.bin")), expected_bytes(grid));
  const std::string xdmf = file_text(scratch.file("dump.xdmf"));
  const std::int64_t second = grid.all_elements().count() * 8;
  EXPECT_TRUE(contains(xdmf, "Endian=\"Little\" Seek=\"" + std::to_string(second) + "\">dump.bin<")) << xdmf;
  EXPECT_FALSE(std::filesystem::exists(scratch.file("dump.bin.partial")));
}

TEST(FieldDump, BytesDoNotDependOnTheRanks3D) { expect_analytic_bytes<3>(); }
TEST(FieldDump, BytesDoNotDependOnTheRanks2D) { expect_analytic_bytes<2>(); }

TEST(FieldDump, FailsOnAllRanksWithoutADirectory) {
  const test::ScratchDirectory scratch;
  const Grid<3> grid = test::odd_grid<3>();
  const SampleFields<3> sample(grid);
  const std::string text = error_text<OutputError>(
      [&] { write_field_dump(PETSC_COMM_WORLD, sample.set, scratch.file("missing/dump")); });
  EXPECT_TRUE(contains(text, "missing/dump.bin")) << text;
}

TEST(FieldDump, NoticesAFullDisk) {
  const test::SmallDisk disk("200k");
  if (!disk.mounted()) GTEST_SKIP() << "needs the privilege to mount a tmpfs";
  Domain<3> domain;
  domain.size = {1.0, 1.0, 1.0};
  domain.elements = {40, 20, 30};
  const Grid<3> grid(PETSC_COMM_WORLD, domain, {});
  const std::vector<double> density = analytic_field<3>(grid.owned_elements(), 1);
  const std::vector<double> displacement = analytic_field<3>(grid.owned_nodes(), 3);
  FieldSet<3> small{&grid, {}}, large{&grid, {}};
  small.add_elements("density", density);  // 192,000 bytes
  small.fields.back().single_precision = true;
  large.add_elements("density", density);
  large.add_nodes("displacement", displacement, 3);

  const std::string text =
      error_text<OutputError>([&] { write_field_dump(PETSC_COMM_WORLD, large, disk.file("dump")); });
  EXPECT_TRUE(contains(text, disk.file("dump.bin"))) << text;
  MPI_Barrier(PETSC_COMM_WORLD);
  EXPECT_TRUE(std::filesystem::is_empty(disk.path()));
  MPI_Barrier(PETSC_COMM_WORLD);
  EXPECT_NO_THROW(write_field_dump(PETSC_COMM_WORLD, small, disk.file("dump")));
  if (is_first()) {
    EXPECT_EQ(std::filesystem::file_size(disk.file("dump.bin")), 96000u);
  }
}

TEST(FieldDump, NoticesAFullDiskWhereverItHappens) {
  const Grid<3> grid = test::odd_grid<3>();
  const SampleFields<3> sample(grid);
  int failures = 0;
  bool fits = false;
  for (int kilobytes = 4; !fits && kilobytes <= 100; kilobytes += 4) {
    const test::SmallDisk disk(std::to_string(kilobytes) + "k");
    if (!disk.mounted()) GTEST_SKIP() << "needs the privilege to mount a tmpfs";
    try {
      write_field_dump(PETSC_COMM_WORLD, sample.set, disk.file("dump"));
      fits = true;
    } catch (const OutputError& error) {
      EXPECT_TRUE(contains(error.what(), disk.file("dump"))) << error.what();
      ++failures;
    }
    MPI_Barrier(PETSC_COMM_WORLD);
    if (!fits) {
      EXPECT_FALSE(std::filesystem::exists(disk.file("dump.xdmf"))) << kilobytes;
    } else if (is_first()) {
      EXPECT_EQ(file_text(disk.file("dump.bin")), expected_bytes(grid));
    }
  }
  EXPECT_TRUE(fits);
  EXPECT_GE(failures, 3);
}

/// Coordinates of nodes or element centres, [entity][axis].
template <int Dim>
std::vector<double> positions(const Grid<Dim>& grid, bool on_nodes) {
  std::vector<double> result;
  const IndexBox<Dim>& box = on_nodes ? grid.owned_nodes() : grid.owned_elements();
  box.for_each([&](const Index<Dim>& index, std::int64_t) {
    const Point<Dim> point = on_nodes ? grid.node_position(index) : grid.element_center(index);
    result.insert(result.end(), point.begin(), point.end());
  });
  return result;
}

bool has_paraview() {
  return std::system("command -v pvpython >/dev/null && command -v Xvfb >/dev/null") == 0;
}

/// Writes the same fields as a dump and as HDF5, and has ParaView compare the two and look at the positions.
template <int Dim>
void expect_paraview_agrees() {
  const test::ScratchDirectory scratch;
  const Grid<Dim> grid = test::odd_grid<Dim>();
  SampleFields<Dim> sample(grid);
  const std::vector<double> nodes = positions(grid, true), centers = positions(grid, false);
  sample.set.add_nodes("node_position", nodes, Dim);
  sample.set.add_elements("cell_position", centers, Dim);

  write_field_dump(PETSC_COMM_WORLD, sample.set, scratch.file("dump"));
  Hdf5Writer writer(PETSC_COMM_WORLD, scratch.file("result.h5"));
  writer.write_fields(sample.set);
  writer.close();
  const OutputDirectory directory(PETSC_COMM_WORLD, scratch.path(), false);
  directory.write("result.xdmf", hdf5_xdmf(sample.set, "result.h5"));
  if (!is_first()) return;
  // A clean environment: pvpython would take the launcher's variables for its own.
  const std::string command =
      "env -i PATH=\"$PATH\" HOME=\"${HOME:-/tmp}\" " FABSEQ_TEST_DATA
      "/../../scripts/fabseq-tools virtual-display pvpython " FABSEQ_TEST_DATA "/../scripts/read_xdmf.py " +
      scratch.file("dump.xdmf") + " " + scratch.file("result.xdmf") + " > " + scratch.file("log") + " 2>&1";
  const int status = std::system(command.c_str());
  EXPECT_EQ(WIFEXITED(status) ? WEXITSTATUS(status) : -1, 0) << file_text(scratch.file("log"));
}

TEST(FieldDump, OpensInParaView) {
  if (size_of(PETSC_COMM_WORLD) != 2)
    GTEST_SKIP() << "ranks: once is enough: the bytes are the same on any number";
  if (broadcast(PETSC_COMM_WORLD, is_first() && has_paraview() ? "yes" : "").empty())
    GTEST_SKIP() << "pvpython or Xvfb is not installed";
  expect_paraview_agrees<3>();
  expect_paraview_agrees<2>();
}

}  // namespace
}  // namespace fabseq
