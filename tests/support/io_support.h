// SPDX-License-Identifier: MIT
/// \file
/// What the tests of output share: scratch directories, a disk that is full soon, fields with known values.
#pragma once

#include "fabseq/base/error.h"
#include "fabseq/base/mpi.h"
#include "fabseq/files/field_set.h"
#include "fabseq/grid/grid.h"

#include <gtest/gtest.h>
#include <petscsys.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>
#include <sys/mount.h>
#include <vector>

namespace fabseq::test {

inline bool is_first() { return rank_of(PETSC_COMM_WORLD) == 0; }

/// A directory for one test, the same on all ranks; removed at the end. Collective.
class ScratchDirectory {
 public:
  ScratchDirectory() {
    std::string name = (std::filesystem::temp_directory_path() / "fabseq_test_XXXXXX").string();
    if (is_first() && mkdtemp(name.data()) == nullptr) ADD_FAILURE() << "no scratch directory " << name;
    path_ = broadcast(PETSC_COMM_WORLD, name);
  }
  ScratchDirectory(const ScratchDirectory&) = delete;
  ScratchDirectory& operator=(const ScratchDirectory&) = delete;
  ~ScratchDirectory() {
    MPI_Barrier(PETSC_COMM_WORLD);
    std::error_code ignored;
    if (is_first()) std::filesystem::remove_all(path_, ignored);
  }
  const std::string& path() const { return path_; }
  std::string file(const std::string& name) const { return path_ + "/" + name; }

 private:
  std::string path_;
};

/// A scratch directory on a file system of its own with little room. Mounting needs privileges: see
/// mounted().
class SmallDisk {
 public:
  explicit SmallDisk(const std::string& size) {
    const std::string options = "size=" + size;
    const bool done =
        is_first() && mount("tmpfs", directory_.path().c_str(), "tmpfs", 0, options.c_str()) == 0;
    mounted_ = any(PETSC_COMM_WORLD, done);
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;
  ~SmallDisk() {
    MPI_Barrier(PETSC_COMM_WORLD);
    if (mounted_ && is_first()) (void)umount2(directory_.path().c_str(), MNT_DETACH);
  }
  bool mounted() const { return mounted_; }
  const std::string& path() const { return directory_.path(); }
  std::string file(const std::string& name) const { return directory_.file(name); }
  /// Bytes in use, by rank 0's look.
  std::uintmax_t used() const {
    const std::filesystem::space_info space = std::filesystem::space(path());
    return space.capacity - space.free;
  }

 private:
  ScratchDirectory directory_;
  bool mounted_ = false;
};

/// The text of the ErrorType that `work` throws; a failure unless it throws one, with the same text on all
/// ranks.
template <class ErrorType>
std::string error_text(const std::function<void()>& work) {
  std::string text = "nothing thrown";
  try {
    work();
    ADD_FAILURE() << "no error thrown";
  } catch (const ErrorType& error) {
    text = error.what();
  } catch (const std::exception& error) {
    ADD_FAILURE() << "another error thrown: " << error.what();
  }
  EXPECT_EQ(text, broadcast(PETSC_COMM_WORLD, text));
  EXPECT_EQ(text.find('\n'), std::string::npos) << text;
  return text;
}

inline std::string file_text(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

inline bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// Value of component c at entity (i, j, k), different everywhere and no single-precision number.
template <int Dim>
double analytic(const Index<Dim>& index, int component) {
  double value = 0.1 + component;
  double factor = 10.0;
  for (int axis = 0; axis < Dim; ++axis, factor *= 10.0) value += factor * index[axis];
  return value;
}

/// analytic() on a box, [entity][component].
template <int Dim>
std::vector<double> analytic_field(const IndexBox<Dim>& box, int components) {
  std::vector<double> values;
  box.for_each([&](const Index<Dim>& index, std::int64_t) {
    for (int c = 0; c < components; ++c) values.push_back(analytic<Dim>(index, c));
  });
  return values;
}

/// The analytic field where the first index is even, 0 elsewhere: where it has values, which, and as a whole.
template <int Dim>
struct PartialField {
  std::vector<int> places;
  std::vector<double> values, whole;

  PartialField(const IndexBox<Dim>& box, int components) {
    box.for_each([&](const Index<Dim>& index, std::int64_t offset) {
      const bool has_values = index[0] % 2 == 0;
      if (has_values) places.push_back(static_cast<int>(offset));
      for (int c = 0; c < components; ++c) {
        whole.push_back(has_values ? analytic<Dim>(index, c) : 0.0);
        if (has_values) values.push_back(whole.back());
      }
    });
  }
};

/// A grid with odd numbers of elements, unequal edges, and shares of different size.
template <int Dim>
Grid<Dim> odd_grid() {
  Domain<Dim> domain;
  const int elements[] = {7, 3, 5};
  const double size[] = {3.5, 0.6, 4.0};
  for (int axis = 0; axis < Dim; ++axis) {
    domain.elements[axis] = Dim == 2 ? 5 - axis : elements[axis];
    domain.size[axis] = size[axis];
  }
  const auto weights = [](const IndexBox<Dim>& box) {
    std::vector<double> result;
    box.for_each([&](const Index<Dim>& index, std::int64_t) { result.push_back(index[0] < 2 ? 5.0 : 1.0); });
    return result;
  };
  return Grid<Dim>(PETSC_COMM_WORLD, domain, weights);
}

}  // namespace fabseq::test
