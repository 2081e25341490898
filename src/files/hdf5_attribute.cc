// SPDX-License-Identifier: MIT
#include "fabseq/files/hdf5_attribute.h"

#include "fabseq/base/hdf5.h"

#include <cstdint>
#include <stdexcept>

namespace fabseq {

namespace {

Hdf5Datatype boolean_type() {
  Hdf5Datatype type(H5Tenum_create(H5T_NATIVE_INT8));
  for (const signed char value : {0, 1}) (void)H5Tenum_insert(type, value == 0 ? "FALSE" : "TRUE", &value);
  return type;
}

Hdf5Datatype string_type() {
  Hdf5Datatype type(H5Tcopy(H5T_C_S1));
  (void)H5Tset_size(type, H5T_VARIABLE);
  (void)H5Tset_cset(type, H5T_CSET_UTF8);
  return type;
}

bool write_scalar(hid_t object, const std::string& name, hid_t file_type, hid_t memory_type,
                  const void* value) {
  if (H5Aexists(object, name.c_str()) > 0 && H5Adelete(object, name.c_str()) < 0) return false;
  const Hdf5Dataspace space(H5Screate(H5S_SCALAR));
  Hdf5Attribute attribute(H5Acreate2(object, name.c_str(), file_type, space, H5P_DEFAULT, H5P_DEFAULT));
  return attribute && H5Awrite(attribute, memory_type, value) >= 0 && attribute.close();
}

/// The attribute, if it is there and holds one value.
Hdf5Attribute open_scalar(hid_t object, const std::string& name) {
  if (H5Aexists(object, name.c_str()) <= 0) return {};
  Hdf5Attribute attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT));
  const Hdf5Dataspace space(attribute ? H5Aget_space(attribute) : H5I_INVALID_HID);
  if (!space || H5Sget_simple_extent_npoints(space) != 1) return {};
  return attribute;
}

template <class Value>
std::optional<Value> read_number(hid_t attribute, hid_t memory_type) {
  Value value{};
  if (H5Aread(attribute, memory_type, &value) < 0) return std::nullopt;
  return value;
}

std::optional<Json> read_string(hid_t attribute, hid_t file_type) {
  if (H5Tis_variable_str(file_type) <= 0) return std::nullopt;
  const Hdf5Datatype type = string_type();
  char* text = nullptr;
  if (H5Aread(attribute, type, static_cast<void*>(&text)) < 0) return std::nullopt;
  const std::string result = text == nullptr ? "" : text;
  (void)H5free_memory(text);
  return Json(result);
}

}  // namespace

bool write_attribute(hid_t object, const std::string& name, const Json& value) {
  if (value.is_boolean()) {
    const signed char number = value.get<bool>() ? 1 : 0;
    const Hdf5Datatype type = boolean_type();
    return type && write_scalar(object, name, type, type, &number);
  }
  if (value.is_number_unsigned()) {
    const std::uint64_t number = value.get<std::uint64_t>();
    return write_scalar(object, name, H5T_STD_U64LE, H5T_NATIVE_UINT64, &number);
  }
  if (value.is_number_integer()) {
    const std::int64_t number = value.get<std::int64_t>();
    return write_scalar(object, name, H5T_STD_I64LE, H5T_NATIVE_INT64, &number);
  }
  if (value.is_number()) {
    const double number = value.get<double>();
    return write_scalar(object, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, &number);
  }
  if (value.is_string()) {
    const char* text = value.get_ref<const std::string&>().c_str();
    const Hdf5Datatype type = string_type();
    return type && write_scalar(object, name, type, type, static_cast<const void*>(&text));
  }
  throw std::invalid_argument("HDF5 attribute '" + name + "' is no boolean, number or string");
}

std::optional<Json> read_attribute(hid_t object, const std::string& name) {
  const Hdf5Attribute attribute = open_scalar(object, name);
  const Hdf5Datatype type(attribute ? H5Aget_type(attribute) : H5I_INVALID_HID);
  if (!type) return std::nullopt;
  switch (H5Tget_class(type)) {
    case H5T_INTEGER:
      if (H5Tget_sign(type) == H5T_SGN_NONE) return read_number<std::uint64_t>(attribute, H5T_NATIVE_UINT64);
      return read_number<std::int64_t>(attribute, H5T_NATIVE_INT64);
    case H5T_FLOAT:
      return read_number<double>(attribute, H5T_NATIVE_DOUBLE);
    case H5T_STRING:
      return read_string(attribute, type);
    case H5T_ENUM: {
      const auto value = read_number<signed char>(attribute, boolean_type());
      return value ? std::optional<Json>(Json(*value != 0)) : std::nullopt;
    }
    default:
      return std::nullopt;
  }
}

std::vector<std::string> attribute_names(hid_t object) {
  std::vector<std::string> names;
  const auto collect = [](hid_t, const char* name, const H5A_info_t*, void* data) -> herr_t {
    static_cast<std::vector<std::string>*>(data)->emplace_back(name);
    return 0;
  };
  (void)H5Aiterate2(object, H5_INDEX_NAME, H5_ITER_INC, nullptr, collect, &names);
  return names;
}

}  // namespace fabseq
