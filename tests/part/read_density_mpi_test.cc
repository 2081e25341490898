// SPDX-License-Identifier: MIT
/// Voxel files of all kinds, written by one rank through plain HDF5, read in parallel; and every way they can
/// be wrong.
#include "fabseq/base/hdf5.h"
#include "fabseq/base/mpi.h"
#include "fabseq/part/part.h"
#include "support/refusal.h"
#include "support/shapes.h"
#include "support/whole_field.h"

#include <gtest/gtest.h>
#include <petscsys.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <unistd.h>

namespace fabseq {
namespace {

const Domain<3> domain{{1.4, 0.9, 2.5}, {7, 3, 5}, 1.0};
constexpr int total = 7 * 3 * 5;

/// The file's values, a different one for each voxel.
double density_of(int number) { return (number % 21) / 20.0; }

void write(hid_t file, const char* name, hid_t stored, std::vector<hsize_t> shape,
           const std::vector<double>& values, bool compressed = false) {
  const Hdf5Dataspace space(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr));
  const Hdf5PropertyList creation(H5Pcreate(H5P_DATASET_CREATE));
  if (compressed) {
    const std::vector<hsize_t> chunk = {2, 2, 3};
    H5Pset_chunk(creation, 3, chunk.data());
    H5Pset_deflate(creation, 4);
  }
  const Hdf5Dataset dataset(H5Dcreate2(file, name, stored, space, H5P_DEFAULT, creation, H5P_DEFAULT));
  H5Dwrite(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
}

/// As h5py stores numpy's bool.
void write_booleans(hid_t file, const char* name, const std::vector<std::int8_t>& values) {
  const Hdf5Datatype type(H5Tenum_create(H5T_NATIVE_INT8));
  const std::int8_t no = 0, yes = 1;
  H5Tenum_insert(type, "FALSE", &no);
  H5Tenum_insert(type, "TRUE", &yes);
  const std::vector<hsize_t> shape = {5, 3, 7};
  const Hdf5Dataspace space(H5Screate_simple(3, shape.data(), nullptr));
  const Hdf5Dataset dataset(H5Dcreate2(file, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
}

/// A filter that is there while the file is written, as h5py has its own. It changes nothing.
class OwnCompression {
 public:
  OwnCompression(H5Z_filter_t number, const char* name) : number_(number) {
    const H5Z_class2_t filter = {H5Z_CLASS_T_VERS, number, 1, 1, name, nullptr, nullptr, same};
    H5Zregister(&filter);
  }
  OwnCompression(OwnCompression&&) = delete;
  ~OwnCompression() { H5Zunregister(number_); }

  void write(hid_t file, const char* dataset, const std::vector<double>& values) const {
    const std::vector<hsize_t> shape = {5, 3, 7}, chunk = {2, 2, 3};
    const Hdf5Dataspace space(H5Screate_simple(3, shape.data(), nullptr));
    const Hdf5PropertyList creation(H5Pcreate(H5P_DATASET_CREATE));
    H5Pset_chunk(creation, 3, chunk.data());
    H5Pset_filter(creation, number_, H5Z_FLAG_OPTIONAL, 0, nullptr);
    const Hdf5Dataset made(
        H5Dcreate2(file, dataset, H5T_IEEE_F64LE, space, H5P_DEFAULT, creation, H5P_DEFAULT));
    H5Dwrite(made, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  }

 private:
  static size_t same(unsigned, size_t, const unsigned[], size_t bytes, size_t*, void**) { return bytes; }

  H5Z_filter_t number_;
};

void write_file(const std::string& path) {
  const Hdf5File file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT));
  std::vector<double> grey(total), percent(total), negative(total), gaps(total);
  std::vector<std::int8_t> booleans(total);
  for (int i = 0; i < total; ++i) {
    grey[i] = density_of(i);
    percent[i] = std::round(100.0 * grey[i]);
    negative[i] = grey[i] - 0.25;
    gaps[i] = i == 50 ? NAN : grey[i];
    booleans[i] = static_cast<std::int8_t>(i % 3 == 0);
  }
  const std::vector<hsize_t> shape = {5, 3, 7};
  write(file, "density", H5T_IEEE_F64LE, shape, grey);
  write(file, "single", H5T_IEEE_F32BE, shape, grey);
  write(file, "compressed", H5T_IEEE_F64LE, shape, grey, true);
  write(file, "percent", H5T_STD_U8LE, shape, percent);
  write(file, "turned", H5T_IEEE_F64LE, {7, 3, 5}, grey);
  write(file, "flat", H5T_IEEE_F64LE, {total}, grey);
  write(file, "negative", H5T_IEEE_F64LE, shape, negative);
  write(file, "gaps", H5T_IEEE_F64LE, shape, gaps);
  write(file, "plane", H5T_IEEE_F64LE, {3, 7}, std::vector<double>(grey.begin(), grey.begin() + 21));
  std::vector<double> rounded = grey, beyond = grey;
  rounded[3] = -1e-12;
  rounded[20] = 1.0000001;
  beyond[20] = 1.00001;
  write(file, "rounded", H5T_IEEE_F64LE, shape, rounded);
  write(file, "beyond", H5T_IEEE_F64LE, shape, beyond);
  OwnCompression(32000, "of h5py").write(file, "lzf", grey);
  OwnCompression(40000, "of nobody").write(file, "unknown", grey);
  write_booleans(file, "solid", booleans);
  const Hdf5Group group(H5Gcreate2(file, "steps", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  write(group, "last", H5T_IEEE_F64LE, shape, grey);
  const Hdf5Datatype text(H5Tcopy(H5T_C_S1));
  const Hdf5Dataspace space(H5Screate_simple(3, shape.data(), nullptr));
  const Hdf5Dataset words(H5Dcreate2(file, "words", text, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
}

class ReadDensity : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    silence_hdf5();
    const auto directory =
        std::filesystem::temp_directory_path() / ("fabseq_read_density_" + std::to_string(getpid()));
    directory_ = broadcast(PETSC_COMM_WORLD, directory.string());
    if (rank_of(PETSC_COMM_WORLD) == 0) {
      std::filesystem::create_directories(directory_);
      write_file(path("part.h5"));
      std::ofstream(path("text.h5")) << "not HDF5\n";
    }
    MPI_Barrier(PETSC_COMM_WORLD);
  }
  static void TearDownTestSuite() {
    MPI_Barrier(PETSC_COMM_WORLD);
    if (rank_of(PETSC_COMM_WORLD) == 0) std::filesystem::remove_all(directory_);
  }
  static std::string path(const std::string& name) { return directory_ + "/" + name; }
  static PartDescription voxels(const std::string& dataset, std::optional<double> threshold = {},
                                const std::string& file = "part.h5") {
    return {VoxelFile{path(file), dataset, threshold}, false};
  }
  /// The whole field, read by all ranks in their own boxes.
  static std::vector<double> read(const PartDescription& description) {
    const Grid<3> grid(PETSC_COMM_WORLD, domain, nullptr);
    const auto own = read_density<3>(grid.comm(), domain, description, grid.owned_elements());
    return test::whole_element_field<3>(grid, own);
  }
  static std::string refusal(const PartDescription& description) {
    return test::refusal([&] { (void)read(description); });
  }

  static std::string directory_;
};
std::string ReadDensity::directory_;

TEST_F(ReadDensity, ReadsGreyDensitiesOfAnyNumericType) {
  for (const char* name : {"density", "single", "compressed", "steps/last"}) {
    const std::vector<double> field = read(voxels(name));
    for (int i = 0; i < total; ++i) EXPECT_NEAR(field[i], density_of(i), 1e-7) << name << " " << i;
  }
}

TEST_F(ReadDensity, BringsRoundedValuesIntoTheRange) {
  const std::vector<double> field = read(voxels("rounded"));
  for (int i = 0; i < total; ++i) EXPECT_EQ(field[i], i == 3 ? 0.0 : density_of(i)) << i;
}

TEST_F(ReadDensity, AppliesTheThreshold) {
  const std::vector<double> field = read(voxels("percent", 50.0));
  for (int i = 0; i < total; ++i) EXPECT_EQ(field[i], i % 21 >= 10 ? 1.0 : 0.0) << i;
  const std::vector<double> solid = read(voxels("solid"));
  for (int i = 0; i < total; ++i) EXPECT_EQ(solid[i], i % 3 == 0 ? 1.0 : 0.0) << i;
}

/// 4 x 2 x 3 elements over 7 x 3 x 5 voxels: the last element of each axis is half empty.
TEST_F(ReadDensity, AveragesFinerVoxels) {
  const Domain<3> coarse{{1.6, 1.2, 3.0}, {4, 2, 3}, 1.0};
  PartDescription description = voxels("density");
  description.sampling = 2;
  const Grid<3> grid(PETSC_COMM_WORLD, coarse, nullptr);
  const auto own = read_density<3>(grid.comm(), coarse, description, grid.owned_elements());
  const std::vector<double> found = test::whole_element_field<3>(grid, own);
  std::vector<double> expected(24, 0.0);
  const IndexBox<3> voxel_box{{}, {7, 3, 5}}, coarse_box{{}, {4, 2, 3}};
  voxel_box.for_each([&](const Index<3>& voxel, std::int64_t number) {
    const Index<3> element = {voxel[0] / 2, voxel[1] / 2, voxel[2] / 2};
    expected[coarse_box.offset(element)] += density_of(static_cast<int>(number)) / 8.0;
  });
  for (int i = 0; i < 24; ++i) EXPECT_NEAR(found[i], expected[i], 1e-14) << i;
}

/// On a grid twice as fine, whatever box a rank has of it, also with several samples to an element.
TEST_F(ReadDensity, RepeatsValuesOnAFinerGrid) {
  const IndexBox<3> voxel_box{{}, domain.elements};
  for (const int sampling : {1, 3}) {
    Domain<3> fine = domain;
    for (int& elements : fine.elements) elements *= 2;
    PartDescription description = voxels("density");
    std::get<VoxelFile>(description.source).repeat = 2 * sampling;
    description.sampling = sampling;
    const Grid<3> grid(PETSC_COMM_WORLD, fine, nullptr);
    const auto own = read_density<3>(grid.comm(), fine, description, grid.owned_elements());
    grid.owned_elements().for_each([&](const Index<3>& element, std::int64_t offset) {
      const Index<3> voxel = {element[0] / 2, element[1] / 2, element[2] / 2};
      EXPECT_NEAR(own[offset], density_of(static_cast<int>(voxel_box.offset(voxel))), 1e-14);
    });
  }
}

TEST_F(ReadDensity, SamplesShapes) {
  // A disc of radius 1 in a square of 2 x 2 on 2 x 2 elements of 40 x 40 points: its area.
  const Domain<2> square{{2.0, 2.0}, {2, 2}, 1.0};
  Shape disc;
  disc.kind = Shape::Kind::sphere;
  disc.first = {1.0, 1.0};
  disc.radius = 1.0;
  const PartDescription description{.source = disc, .sampling = 40};
  const auto density = read_density<2>(PETSC_COMM_SELF, square, description, {{}, {2, 2}});
  for (const double value : density) EXPECT_NEAR(value, std::acos(-1.0) / 4.0, 2e-3);
}

TEST_F(ReadDensity, ReadsPlanes) {
  const Domain<2> plane{{1.4, 0.9}, {7, 3}, 1.0};
  const Grid<2> grid(PETSC_COMM_WORLD, plane, nullptr);
  const auto own = read_density<2>(grid.comm(), plane, voxels("plane"), grid.owned_elements());
  const std::vector<double> field = test::whole_element_field<2>(grid, own);
  for (int i = 0; i < 21; ++i) EXPECT_EQ(field[i], density_of(i));
}

TEST_F(ReadDensity, TakesEmptyBoxes) {
  IndexBox<3> box{{}, domain.elements};
  if (rank_of(PETSC_COMM_WORLD) != 0) box.size = {0, 3, 5};
  const auto values = read_density<3>(PETSC_COMM_WORLD, domain, voxels("density"), box);
  ASSERT_EQ(values.size(), static_cast<std::size_t>(box.count()));
  for (std::size_t i = 0; i < values.size(); ++i) EXPECT_EQ(values[i], density_of(static_cast<int>(i))) << i;
}

TEST_F(ReadDensity, BalancesVoxelParts) {
  const PartDescription description = voxels("density", 0.5);
  const Grid<3> grid = make_balanced_grid<3>(PETSC_COMM_WORLD, domain, description);
  const auto own = read_density<3>(grid.comm(), domain, description, grid.owned_elements());
  const std::vector<double> field = test::whole_element_field<3>(grid, own);
  for (int i = 0; i < total; ++i) EXPECT_EQ(field[i], i % 21 >= 10 ? 1.0 : 0.0) << i;
  const double filled = std::accumulate(own.begin(), own.end(), 0.0);
  double most = 0.0;
  MPI_Allreduce(&filled, &most, 1, MPI_DOUBLE, MPI_MAX, PETSC_COMM_WORLD);
  // 55 filled voxels; planes between ranks cannot cut them into equal numbers.
  EXPECT_LE(most, 1.4 * 55 / size_of(PETSC_COMM_WORLD));
}

TEST_F(ReadDensity, NamesTheFileThatIsWrong) {
  const std::string missing = refusal(voxels("density", {}, "no_such.h5"));
  EXPECT_EQ(missing.rfind("/part/voxels/file: cannot open '" + path("no_such.h5") + "' (No such file", 0), 0u)
      << missing;
  const std::string text = refusal(voxels("density", {}, "text.h5"));
  EXPECT_EQ(text.rfind("/part/voxels/file: '" + path("text.h5") + "' is not an HDF5 file", 0), 0u) << text;
  const std::string directory = refusal(voxels("density", {}, ""));
  EXPECT_EQ(directory.rfind("/part/voxels/file: ", 0), 0u) << directory;
}

TEST_F(ReadDensity, NamesTheDatasetThatIsWrong) {
  for (const char* name : {"densities", "steps", "steps/first", "nowhere/density", ""}) {
    const std::string missing = refusal(voxels(name));
    EXPECT_EQ(missing.rfind("/part/voxels/dataset: no dataset '" + std::string(name) + "' in '", 0), 0u)
        << missing;
    EXPECT_NE(missing.find("'density'"), std::string::npos) << missing;
  }
  const std::string words = refusal(voxels("words"));
  EXPECT_NE(words.find("is not numeric"), std::string::npos) << words;
  const std::string turned = refusal(voxels("turned"));
  EXPECT_NE(turned.find("has shape [7,3,5], needs [5,3,7] (domain.elements reversed)"), std::string::npos)
      << turned;
  const std::string flat = refusal(voxels("flat"));
  EXPECT_NE(flat.find("has shape [105], needs [5,3,7]"), std::string::npos) << flat;
}

TEST_F(ReadDensity, NamesACompressionThatItCannotUndo) {
  for (const auto& [name, compression] : {std::pair("lzf", "lzf"), std::pair("unknown", "'of nobody'")}) {
    const std::string text = refusal(voxels(name));
    EXPECT_EQ(text.rfind("/part/voxels/dataset: dataset '" + std::string(name) + "' of '", 0), 0u) << text;
    EXPECT_NE(text.find("' is compressed with " + std::string(compression) + ", which this HDF5"),
              std::string::npos)
        << text;
  }
}

TEST_F(ReadDensity, RefusesDensitiesThatAreNone) {
  const std::string negative = refusal(voxels("negative"));
  EXPECT_NE(negative.find("values from -0.25 to 0.75, needs densities from 0 to 1"), std::string::npos)
      << negative;
  const std::string percent = refusal(voxels("percent"));
  EXPECT_NE(percent.find("values from 0 to 100"), std::string::npos) << percent;
  const std::string beyond = refusal(voxels("beyond"));
  EXPECT_NE(beyond.find("values from 0 to 1.00001,"), std::string::npos) << beyond;
  for (const std::optional<double> threshold : {std::optional<double>(), std::optional<double>(0.5)}) {
    const std::string gaps = refusal(voxels("gaps", threshold));
    EXPECT_NE(gaps.find("1 values that are not a number"), std::string::npos) << gaps;
  }
}

TEST(ReadShape, EvaluatesAtCentresWithTolerance) {
  // The face x = 0.5 + 1e-8 outside / 1e-3 outside the shape.
  const Domain<2> plane{{2.0, 1.0}, {2, 1}, 1.0};
  const IndexBox<2> all{{}, plane.elements};
  const auto inside = [&](double edge) {
    return read_density<2>(PETSC_COMM_WORLD, plane, {test::box({edge, 0}, {2, 1}), false}, all);
  };
  EXPECT_EQ(inside(0.5 + 1e-8), (std::vector<double>{1.0, 1.0}));
  EXPECT_EQ(inside(0.5 + 1e-3), (std::vector<double>{0.0, 1.0}));
}

}  // namespace
}  // namespace fabseq
