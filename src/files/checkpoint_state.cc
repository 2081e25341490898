// SPDX-License-Identifier: MIT
#include "fabseq/files/checkpoint_state.h"

#include "fabseq/base/error.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace fabseq {

namespace {

template <class Values>
const typename Values::mapped_type& find(const Values& values, const std::string& name) {
  const auto found = values.find(name);
  if (found != values.end()) return found->second;
  throw InputError("-restart: the checkpoint has no '" + name +
                   "'; allowed: one written by this version of fabseq");
}

void require(bool condition, const std::string& name) {
  if (!condition)
    throw InputError(
        "-restart: '" + name +
        "' of the checkpoint is of the wrong kind; allowed: one written by this version of fabseq");
}

}  // namespace

void CheckpointState::set_scalar(const std::string& name, Json value) {
  if (value.is_number() && !std::isfinite(value.get<double>()))
    throw std::invalid_argument("CheckpointState: '" + name + "' is not finite");
  scalars_[name] = std::move(value);
}

void CheckpointState::set_array(const std::string& name, std::vector<double> values) {
  if (!std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); }))
    throw std::invalid_argument("CheckpointState: '" + name + "' is not finite");
  arrays_[name] = std::move(values);
}

int CheckpointState::integer(const std::string& name) const {
  require(find(scalars_, name).is_number_integer(), name);
  return static_cast<int>(find(scalars_, name).get<std::int64_t>());
}

double CheckpointState::number(const std::string& name) const {
  require(find(scalars_, name).is_number(), name);
  return find(scalars_, name).get<double>();
}

const std::string& CheckpointState::text(const std::string& name) const {
  require(find(scalars_, name).is_string(), name);
  return find(scalars_, name).get_ref<const std::string&>();
}

const std::vector<double>& CheckpointState::array(const std::string& name) const {
  return find(arrays_, name);
}

const std::vector<double>& CheckpointState::field(const std::string& name) const {
  return find(fields_, name);
}

}  // namespace fabseq
