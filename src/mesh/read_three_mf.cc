// SPDX-License-Identifier: MIT
#include "fabseq/base/error.h"
#include "fabseq/base/plain_numbers.h"
#include "mesh/mesh_formats.h"
#include "mesh/three_mf_package.h"

#include <Model/COM/NMR_DLLInterfaces.h>
#include <algorithm>
#include <exception>
#include <map>
#include <memory>
#include <utility>

namespace fabseq {

namespace {

/// Owner of an object of lib3mf.
struct Release {
  void operator()(NMR::PLib3MFBase* object) const { (void)NMR::lib3mf_release(object); }
};
using Handle = std::unique_ptr<NMR::PLib3MFBase, Release>;

/// Refuses what failed in a call on an object of lib3mf, with its own text.
void require(LIB3MFRESULT result, NMR::PLib3MFBase* object) {
  if (result == LIB3MF_OK) return;
  DWORD code = 0;
  LPCSTR text = nullptr;
  (void)NMR::lib3mf_getlasterror(object, &code, &text);
  throw InputError("cannot be read (" + std::string(text != nullptr ? text : "no reason given") +
                   "), needs an intact 3MF file");
}

/// Calls a function of lib3mf on an object of it. Throws InputError if that fails.
template <class... Parameters, class... Arguments>
void call(LIB3MFRESULT (*function)(NMR::PLib3MFBase*, Parameters...), NMR::PLib3MFBase* object,
          Arguments... arguments) {
  require(function(object, arguments...), object);
}

/// What a function of lib3mf hands out in its last parameter.
template <class... Parameters, class... Arguments>
Handle handle(LIB3MFRESULT (*function)(NMR::PLib3MFBase*, Parameters...), NMR::PLib3MFBase* object,
              Arguments... arguments) {
  NMR::PLib3MFBase* found = nullptr;
  call(function, object, arguments..., &found);
  return Handle(found);
}
template <class Value, class... Parameters>
Value value(LIB3MFRESULT (*function)(NMR::PLib3MFBase*, Parameters...), NMR::PLib3MFBase* object) {
  Value found{};
  call(function, object, &found);
  return found;
}

/// An affine map: a row of the matrix and the shift along each axis.
using Placement = std::array<std::array<double, 4>, 3>;

Placement placement_of(const NMR::MODELTRANSFORM& transform) {
  Placement result;
  for (int row = 0; row < 3; ++row) std::copy_n(transform.m_fFields[row], 4, result[row].begin());
  return result;
}

/// First `inner`, then `outer`.
Placement product(const Placement& outer, const Placement& inner) {
  Placement result;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) {
      result[row][column] = column == 3 ? outer[row][3] : 0.0;
      for (int k = 0; k < 3; ++k) result[row][column] += outer[row][k] * inner[k][column];
    }
  return result;
}

bool mirrors(const Placement& p) {
  return p[0][0] * (p[1][1] * p[2][2] - p[1][2] * p[2][1]) -
             p[0][1] * (p[1][0] * p[2][2] - p[1][2] * p[2][0]) +
             p[0][2] * (p[1][0] * p[2][1] - p[1][1] * p[2][0]) <
         0.0;
}

template <class F>
void for_each_component(NMR::PLib3MFBase* object, const F& f) {
  if (value<BOOL>(NMR::lib3mf_object_iscomponentsobject, object) == 0) return;
  const auto count = value<DWORD>(NMR::lib3mf_componentsobject_getcomponentcount, object);
  for (DWORD i = 0; i < count; ++i) {
    const Handle component = handle(NMR::lib3mf_componentsobject_getcomponent, object, i);
    const Handle part = handle(NMR::lib3mf_component_getobjectresource, component.get());
    f(part.get(),
      placement_of(value<NMR::MODELTRANSFORM>(NMR::lib3mf_component_gettransform, component.get())));
  }
}

bool is_mesh(NMR::PLib3MFBase* object) { return value<BOOL>(NMR::lib3mf_object_ismeshobject, object) != 0; }

/// What objects come to when all their components are followed, which nobody does here: an object has the sum
/// of its components', which come before it in the file.
class UnfoldedSizes {
 public:
  /// Throws InputError if an object comes to more than is allowed.
  void check(NMR::PLib3MFBase* model) {
    const Handle objects = handle(NMR::lib3mf_model_getobjects, model);
    while (value<BOOL>(NMR::lib3mf_resourceiterator_movenext, objects.get()) != 0)
      check_object(handle(NMR::lib3mf_resourceiterator_getcurrent, objects.get()).get());
  }

 private:
  struct Size {
    std::int64_t bodies = 0, triangles = 0;
    int levels = 0;
  };
  static constexpr std::int64_t most_bodies = 10000, most_triangles = 10000000;
  static constexpr int most_levels = 100;

  void check_object(NMR::PLib3MFBase* object) {
    Size size;
    if (is_mesh(object)) size = {1, value<DWORD>(NMR::lib3mf_meshobject_gettrianglecount, object), 0};
    for_each_component(object, [&](NMR::PLib3MFBase* part, const Placement&) {
      const Size& other = sizes_[value<DWORD>(NMR::lib3mf_resource_getresourceid, part)];
      size.bodies += other.bodies;
      size.triangles += other.triangles;
      size.levels = std::max(size.levels, other.levels + 1);
      // A single mesh may be larger than what is made of several.
      if (size.bodies > most_bodies || size.triangles > std::max(most_triangles, other.triangles) ||
          size.levels > most_levels)
        throw InputError("has components that come to more than " + std::to_string(most_bodies) +
                         " bodies, " + std::to_string(most_triangles) + " triangles or " +
                         std::to_string(most_levels) + " levels, which is not allowed");
    });
    sizes_[value<DWORD>(NMR::lib3mf_resource_getresourceid, object)] = size;
  }

  std::map<DWORD, Size> sizes_;
};

/// The objects that the items of a build name.
class ThreeMfModel {
 public:
  explicit ThreeMfModel(std::string& archive) {
    NMR::PLib3MFBase* created = nullptr;
    if (NMR::lib3mf_createmodel(&created) != LIB3MF_OK) throw InputError("cannot be read: no memory");
    model_.reset(created);
    const Handle reader = handle(NMR::lib3mf_model_queryreader, model_.get(), "3mf");
    call(NMR::lib3mf_reader_setprogresscallback, reader.get(), &ThreeMfModel::on_progress,
         static_cast<void*>(this));
    const LIB3MFRESULT result = NMR::lib3mf_reader_readfrombuffer(
        reader.get(), reinterpret_cast<BYTE*>(archive.data()), static_cast<ULONG64>(archive.size()));
    if (refusal_) std::rethrow_exception(refusal_);
    require(result, reader.get());
  }
  ThreeMfModel(ThreeMfModel&&) = delete;  // lib3mf has its address

  std::string unit() const {
    switch (value<DWORD>(NMR::lib3mf_model_getunit, model_.get())) {
      case NMR::MODELUNIT_MICROMETER:
        return "micron";
      case NMR::MODELUNIT_CENTIMETER:
        return "centimeter";
      case NMR::MODELUNIT_METER:
        return "meter";
      case NMR::MODELUNIT_INCH:
        return "inch";
      case NMR::MODELUNIT_FOOT:
        return "foot";
      default:
        return "millimeter";
    }
  }

  /// Calls f(object, placement) for the items of the build, one after the other.
  template <class F>
  void for_each_item(const F& f) const {
    const Handle items = handle(NMR::lib3mf_model_getbuilditems, model_.get());
    while (value<BOOL>(NMR::lib3mf_builditemiterator_movenext, items.get()) != 0) {
      const Handle item = handle(NMR::lib3mf_builditemiterator_getcurrent, items.get());
      const Handle object = handle(NMR::lib3mf_builditem_getobjectresource, item.get());
      f(object.get(),
        placement_of(value<NMR::MODELTRANSFORM>(NMR::lib3mf_builditem_getobjecttransform, item.get())));
    }
  }

 private:
  /// Looks at the objects before lib3mf comes to the items, where it follows components to their ends.
  static bool on_progress(int, NMR::ProgressIdentifier step, void* model) {
    if (step != NMR::PROGRESS_READBUILD) return true;
    auto* self = static_cast<ThreeMfModel*>(model);
    try {
      UnfoldedSizes().check(self->model_.get());
    } catch (...) {
      self->refusal_ = std::current_exception();
    }
    return self->refusal_ == nullptr;
  }

  Handle model_;
  std::exception_ptr refusal_;
};

void add_mesh(NMR::PLib3MFBase* object, const Placement& placement, SurfaceBuilder& surface) {
  std::vector<NMR::MODELMESHVERTEX> corners(value<DWORD>(NMR::lib3mf_meshobject_getvertexcount, object));
  std::vector<NMR::MODELMESHTRIANGLE> triangles(
      value<DWORD>(NMR::lib3mf_meshobject_gettrianglecount, object));
  if (corners.empty() || triangles.empty()) return;
  call(NMR::lib3mf_meshobject_getvertices, object, corners.data(), static_cast<DWORD>(corners.size()),
       nullptr);
  call(NMR::lib3mf_meshobject_gettriangleindices, object, triangles.data(),
       static_cast<DWORD>(triangles.size()), nullptr);
  std::vector<Point<3>> vertices(corners.size());
  for (std::size_t v = 0; v < corners.size(); ++v)
    for (int axis = 0; axis < 3; ++axis) {
      vertices[v][axis] = placement[axis][3];
      for (int k = 0; k < 3; ++k) vertices[v][axis] += placement[axis][k] * corners[v].m_fPosition[k];
    }
  surface.begin(std::move(vertices));
  const bool mirrored = mirrors(placement);
  for (const NMR::MODELMESHTRIANGLE& triangle : triangles) {
    std::array<std::int64_t, 3> polygon;
    std::copy_n(triangle.m_nIndices, 3, polygon.begin());
    if (mirrored) std::swap(polygon[1], polygon[2]);
    surface.add_polygon(polygon);
  }
}

void add_object(NMR::PLib3MFBase* object, const Placement& placement, SurfaceBuilder& surface) {
  if (is_mesh(object)) add_mesh(object, placement, surface);
  for_each_component(object, [&](NMR::PLib3MFBase* part, const Placement& in_object) {
    add_object(part, product(placement, in_object), surface);
  });
}

/// What an object of this type is for, if it does not belong to the product; "" if it does.
std::string purpose_apart(DWORD type) {
  switch (type) {
    case NMR::MODELOBJECTTYPE_SUPPORT:
    case NMR::MODELOBJECTTYPE_SOLIDSUPPORT:
      return "support";
    case NMR::MODELOBJECTTYPE_OTHER:
      return "other";
    default:
      return "";
  }
}

}  // namespace

TriangleMesh read_three_mf(std::string file, std::vector<std::string>& notes, std::string& unit) {
  ThreeMfPackage package = prepare_three_mf(std::move(file));
  const PlainNumbers plain;  // lib3mf reads some by strtod()
  const ThreeMfModel model(package.bytes);
  unit = model.unit();
  SurfaceBuilder surface;
  std::map<std::string, int> left_out;
  std::size_t item = 0;
  model.for_each_item([&](NMR::PLib3MFBase* object, const Placement& placement) {
    const bool printable = item >= package.printable.size() || package.printable[item];
    ++item;
    const std::string purpose = purpose_apart(value<DWORD>(NMR::lib3mf_object_gettype, object));
    if (!printable)
      ++left_out["not to be printed"];
    else if (!purpose.empty())
      ++left_out["of type \"" + purpose + '"'];
    else
      add_object(object, placement, surface);
  });
  for (const auto& [reason, count] : left_out)
    notes.push_back(std::to_string(count) + (count == 1 ? " object " : " objects ") + reason +
                    " left out of the part");
  return surface.take();
}

}  // namespace fabseq
