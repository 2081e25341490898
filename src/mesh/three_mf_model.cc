// SPDX-License-Identifier: MIT
#include "mesh/three_mf_model.h"

#include "fabseq/base/error.h"
#include "fabseq/base/plain_numbers.h"

#include <Model/COM/NMR_DLLInterfaces.h>
#include <algorithm>
#include <exception>
#include <map>
#include <memory>

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

Placement placement_of(const NMR::MODELTRANSFORM& transform) {
  Placement result;
  for (int row = 0; row < 3; ++row) std::copy_n(transform.m_fFields[row], 4, result[row].begin());
  return result;
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

void read_mesh(NMR::PLib3MFBase* object, ThreeMfModel::Object& result) {
  std::vector<NMR::MODELMESHVERTEX> corners(value<DWORD>(NMR::lib3mf_meshobject_getvertexcount, object));
  std::vector<NMR::MODELMESHTRIANGLE> triangles(
      value<DWORD>(NMR::lib3mf_meshobject_gettrianglecount, object));
  if (corners.empty() || triangles.empty()) return;
  call(NMR::lib3mf_meshobject_getvertices, object, corners.data(), static_cast<DWORD>(corners.size()),
       nullptr);
  call(NMR::lib3mf_meshobject_gettriangleindices, object, triangles.data(),
       static_cast<DWORD>(triangles.size()), nullptr);
  result.vertices.resize(corners.size());
  for (std::size_t v = 0; v < corners.size(); ++v)
    std::copy_n(corners[v].m_fPosition, 3, result.vertices[v].begin());
  result.triangles.resize(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t)
    std::copy_n(triangles[t].m_nIndices, 3, result.triangles[t].begin());
}

/// A model in the hands of lib3mf.
class LibraryModel {
 public:
  explicit LibraryModel(std::string& archive) {
    NMR::PLib3MFBase* created = nullptr;
    if (NMR::lib3mf_createmodel(&created) != LIB3MF_OK) throw InputError("cannot be read: no memory");
    model_.reset(created);
    const Handle reader = handle(NMR::lib3mf_model_queryreader, model_.get(), "3mf");
    call(NMR::lib3mf_reader_setprogresscallback, reader.get(), &LibraryModel::on_progress,
         static_cast<void*>(this));
    const LIB3MFRESULT result = NMR::lib3mf_reader_readfrombuffer(
        reader.get(), reinterpret_cast<BYTE*>(archive.data()), static_cast<ULONG64>(archive.size()));
    if (refusal_) std::rethrow_exception(refusal_);
    require(result, reader.get());
  }
  LibraryModel(LibraryModel&&) = delete;  // lib3mf has its address

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

  /// All objects. `numbers` gets their indices by their numbers in lib3mf.
  std::vector<ThreeMfModel::Object> objects(std::map<DWORD, std::size_t>& numbers) const {
    std::vector<ThreeMfModel::Object> result;
    for_each_object([&](NMR::PLib3MFBase* object) {
      numbers[value<DWORD>(NMR::lib3mf_resource_getresourceid, object)] = result.size();
      if (ThreeMfModel::Object& added = result.emplace_back(); is_mesh(object)) read_mesh(object, added);
    });
    std::size_t number = 0;
    for_each_object([&](NMR::PLib3MFBase* object) {
      for_each_component(object, [&](NMR::PLib3MFBase* part, const Placement& placement) {
        result[number].components.push_back(
            {numbers.at(value<DWORD>(NMR::lib3mf_resource_getresourceid, part)), placement});
      });
      ++number;
    });
    return result;
  }

  std::vector<ThreeMfModel::Instance> items(const std::map<DWORD, std::size_t>& numbers) const {
    std::vector<ThreeMfModel::Instance> result;
    const Handle items = handle(NMR::lib3mf_model_getbuilditems, model_.get());
    while (value<BOOL>(NMR::lib3mf_builditemiterator_movenext, items.get()) != 0) {
      const Handle item = handle(NMR::lib3mf_builditemiterator_getcurrent, items.get());
      const Handle object = handle(NMR::lib3mf_builditem_getobjectresource, item.get());
      result.push_back(
          {numbers.at(value<DWORD>(NMR::lib3mf_resource_getresourceid, object.get())),
           placement_of(value<NMR::MODELTRANSFORM>(NMR::lib3mf_builditem_getobjecttransform, item.get()))});
    }
    return result;
  }

 private:
  template <class F>
  void for_each_object(const F& f) const {
    const Handle objects = handle(NMR::lib3mf_model_getobjects, model_.get());
    while (value<BOOL>(NMR::lib3mf_resourceiterator_movenext, objects.get()) != 0)
      f(handle(NMR::lib3mf_resourceiterator_getcurrent, objects.get()).get());
  }

  /// Looks at the objects before lib3mf comes to the items, where it follows components to their ends.
  static bool on_progress(int, NMR::ProgressIdentifier step, void* model) {
    if (step != NMR::PROGRESS_READBUILD) return true;
    auto* self = static_cast<LibraryModel*>(model);
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

}  // namespace

ThreeMfModel read_three_mf_model(std::string& archive) {
  const PlainNumbers plain;  // lib3mf reads some by strtod()
  const LibraryModel model(archive);
  std::map<DWORD, std::size_t> numbers;
  ThreeMfModel result;
  result.unit = model.unit();
  result.objects = model.objects(numbers);
  result.items = model.items(numbers);
  return result;
}

}  // namespace fabseq
