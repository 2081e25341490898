// SPDX-License-Identifier: MIT
/// \file
/// A part that comes from a CAD program as a triangle mesh: where it stands, and which elements it fills.
#pragma once

#include "fabseq/grid/grid.h"
#include "fabseq/mesh/mesh_interior.h"
#include "fabseq/part/pieces.h"

#include <mpi.h>

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace fabseq {

/// A turn by an angle around an axis through the origin, counterclockwise for who looks against the axis.
struct Turn {
  std::array<double, 3> axis{};  ///< of any length but 0
  double degrees = 0.0;
};

/// A mesh file (STL, OBJ, PLY, 3MF) and where its mesh is to stand: scaled, then turned, then put on the
/// plate.
struct MeshFile {
  std::string file;  ///< absolute path
  double scale = 1.0;
  std::vector<Turn> turns;  ///< one after the other
  bool as_is = false;       ///< not moved to the plate
  /// Elements count as 1 from this share inside the mesh on, all others as 0. None: the share is the density.
  std::optional<double> fill = 0.5;
  double least_elements = 3.0;  ///< fewer elements across a wall are refused
};

/// The surface of a mesh file where a config puts it.
struct PlacedSurface {
  TriangleMesh mesh;                 ///< in the config's coordinates
  std::array<Point<3>, 3> matrix{};  ///< turns and scale, [row][column]
  Point<3> shift{};
  double unit_factor = 1.0;  ///< from the file's unit to the config's
};

/// Rank 0 reads, all ranks get the surface, in the config's unit of length. Collective on `comm`. Throws what
/// read_body() throws, and InputError on all ranks for a scale with which coordinates become too large.
PlacedSurface read_placed_surface(MPI_Comm comm, const MeshFile& description, const BuildPlate& plate,
                                  const std::string& unit);

/// The mesh of a file in the coordinates of the config.
class PlacedMesh {
 public:
  /// Collective on `comm`. Throws what read_placed_surface() throws, and InputError on all ranks for a mesh
  /// without volume.
  PlacedMesh(MPI_Comm comm, const MeshFile& description, const BuildPlate& plate,
             const std::string& unit = "");
  PlacedMesh(PlacedMesh&&) = delete;

  /// Corners of the bounding box, length unit.
  const Point<3>& lower() const { return bounds_.low; }
  const Point<3>& upper() const { return bounds_.high; }
  std::size_t triangle_count() const { return surface_.mesh.triangles.size(); }
  /// The way from the file's coordinates x to the config's: [row][column] of A and b in A x + b.
  std::array<std::array<double, 4>, 3> placement() const;
  /// Name of the config's unit of length; empty: none.
  const std::string& unit() const { return unit_; }
  /// Another mesh of the same CAD file, in its place.
  TriangleMesh placed(TriangleMesh mesh) const;
  /// Volume inside, length unit cubed: what a closed mesh encloses. Where bodies overlap or the mesh is open,
  /// it comes from samples (MeshInterior).
  double volume() const { return volume_; }

  /// Share of each element of `box` of a domain that lies inside. Not collective.
  FillFractions fill(const Domain<3>& domain, const IndexBox<3>& box) const;
  /// Number of elements of a domain of which `least` or more lies inside. Ranks share the work. Collective on
  /// `comm`.
  std::int64_t count_filled(MPI_Comm comm, const Domain<3>& domain, double least) const;
  /// Share of the volume that lies in a domain's box, from samples; 1 if the box holds the mesh. Ranks share
  /// the work. Collective on `comm`.
  double share_within(MPI_Comm comm, const Domain<3>& domain) const;

 private:
  double measured_volume(MPI_Comm comm) const;
  /// Share of a box that lies inside, from 128 samples along each axis.
  double sampled_share(MPI_Comm comm, const Point<3>& low, const Point<3>& high) const;

  PlacedSurface surface_;
  Bounds bounds_;
  double volume_ = 0.0;
  std::optional<MeshInterior> interior_;  ///< refers to surface_
  std::string unit_;
};

}  // namespace fabseq
