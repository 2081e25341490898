// SPDX-License-Identifier: MIT
#include "config/named_files.h"
#include "fabseq/base/json.h"
#include "fabseq/part/part_settings.h"
#include "support/io_support.h"
#include "support/mesh_files.h"
#include "support/meshes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <random>

namespace fabseq {
namespace {

constexpr double element = 2.5;

/// A tube around a line parallel to the z axis; a cylinder if `inner` is 0.
TriangleMesh tube_mesh(double outer, double inner, double height) {
  constexpr int around = 96;
  TriangleMesh mesh;
  for (const double z : {0.0, height})
    for (const double radius : {outer, inner})
      for (int i = 0; i < around; ++i) {
        const double angle = 2.0 * M_PI * i / around;
        mesh.points.push_back({radius * std::cos(angle), radius * std::sin(angle), z});
      }
  const auto quad = [&](int a, int b, int i) {  // between circles a and b
    const int j = (i + 1) % around;
    mesh.triangles.push_back({a * around + i, a * around + j, b * around + j});
    mesh.triangles.push_back({a * around + i, b * around + j, b * around + i});
  };
  for (int i = 0; i < around; ++i) {
    quad(0, 2, i);
    quad(2, 3, i);
    quad(3, 1, i);
    quad(1, 0, i);
  }
  return mesh;
}

class PlaceMeshTest : public testing::Test {
 protected:
  /// Volume of the elements over that of the mesh, in the box that follows from the mesh.
  double volume_ratio(const TriangleMesh& mesh, const Json& more = Json::object()) {
    const std::string path = scratch_.file("part.stl");
    if (test::is_first()) std::ofstream(path, std::ios::binary) << test::binary_stl(mesh);
    MPI_Barrier(PETSC_COMM_WORLD);
    document_ = {{"domain", {{"element", element}}}, {"part", {{"mesh", {{"file", path}}}}}};
    document_.merge_patch(more);
    const auto placed = place_mesh(PETSC_COMM_WORLD, document_, "/");
    Domain<3> domain;
    for (int axis = 0; axis < 3; ++axis) {
      domain.size[axis] = document_["domain"]["size"][axis].get<double>();
      domain.origin[axis] = document_["domain"]["origin"][axis].get<double>();
      domain.elements[axis] = document_["domain"]["elements"][axis].get<int>();
      EXPECT_LE(domain.origin[axis], placed->lower()[axis] + 1e-4);
      EXPECT_GE(domain.origin[axis] + domain.size[axis], placed->upper()[axis] - 1e-4);
    }
    MPI_Barrier(PETSC_COMM_WORLD);  // the file may change now
    const auto elements = static_cast<double>(placed->count_filled(PETSC_COMM_WORLD, domain, 0.5));
    return elements * std::pow(element, 3) / placed->volume();
  }
  std::vector<int> elements() const { return document_["domain"]["elements"].get<std::vector<int>>(); }

 private:
  test::ScratchDirectory scratch_;
  Json document_;
};

/// Without a choice of the box, whose outer elements would always be half full and so always be built, the
/// mean is 1.05 and the worst 1.2.
TEST_F(PlaceMeshTest, ElementsHaveTheMeshsVolume) {
  std::mt19937 generator(1);
  const auto random = [&](double low, double high) {
    return element * std::uniform_real_distribution<double>(low, high)(generator);
  };
  constexpr int bodies = 200;
  double sum = 0.0, moduli = 0.0, worst = 0.0;
  for (int body = 0; body < bodies; ++body) {
    TriangleMesh mesh;
    if (body % 3 == 0) {
      const double x = random(4, 24), y = random(4, 24), z = random(4, 24);
      mesh = test::box_mesh({0, 0, 0}, {x, y, z});
    } else {
      const double outer = random(body % 3 == 1 ? 3 : 8, body % 3 == 1 ? 12 : 16), wall = random(3, 6);
      mesh = tube_mesh(outer, body % 3 == 1 ? 0.0 : outer - wall, random(6, 24));
      if (body % 2 == 0)  // lies on its side
        for (Point<3>& point : mesh.points) std::rotate(point.begin(), point.begin() + 1, point.end());
    }
    const double error = volume_ratio(mesh) - 1.0;
    sum += error;
    moduli += std::abs(error);
    if (std::abs(error) > std::abs(worst)) worst = error;
  }
  RecordProperty("mean", std::to_string(sum / bodies));
  RecordProperty("mean_modulus", std::to_string(moduli / bodies));
  RecordProperty("worst", std::to_string(worst));
  EXPECT_LT(std::abs(sum) / bodies, 0.01);
  EXPECT_LT(moduli / bodies, 0.02);
  EXPECT_LT(std::abs(worst), 0.1);
}

/// A hundredth of a millimetre in 60 once led to a row of elements at both ends.
TEST_F(PlaceMeshTest, LittleMoreThanWholeElements) {
  EXPECT_NEAR(volume_ratio(test::box_mesh({0, 0, 0}, {60.01, 20.01, 20})), 1.0, 0.001);
  EXPECT_EQ(elements(), (std::vector<int>{26, 10, 8}));
  EXPECT_NEAR(volume_ratio(test::box_mesh({0, 0, 0}, {60, 20, 20})), 1.0, 1e-12);
  EXPECT_EQ(elements(), (std::vector<int>{24, 8, 8}));
}

/// A density between 0 and 1 is right in the smallest box.
TEST_F(PlaceMeshTest, GreyElementsTakeTheSmallestBox) {
  (void)volume_ratio(test::box_mesh({0, 0, 0}, {60.01, 20, 20}), {{"part", {{"mesh", {{"fill", "grey"}}}}}});
  EXPECT_EQ(elements(), (std::vector<int>{25, 8, 8}));
}

}  // namespace
}  // namespace fabseq
