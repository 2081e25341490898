// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/base/json.h"

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace fabseq {

/// What a run carries from one iteration to the next, as named scalars, arrays and fields of the design.
/// Every class with such data adds them to a state and takes them back from one. Names may have groups
/// ("optimizer/low"). Reading a name that is not there throws InputError, on all ranks because all have the
/// same names: the checkpoint then comes from another version. Nothing here is collective.
class CheckpointState {
 public:
  /// Sets a boolean, integer, finite number or string, which is the same on all ranks. Throws
  /// std::invalid_argument for a number that is not finite.
  void set_scalar(const std::string& name, Json value);
  /// Sets a list of finite numbers, which is the same on all ranks. Throws std::invalid_argument if one is
  /// not finite.
  void set_array(const std::string& name, std::vector<double> values);
  /// Sets a vector with one entry per design variable of this rank. If the checkpoint is read on another
  /// number of ranks or layer groups, the vector comes back distributed as theirs.
  void set_field(const std::string& name, std::vector<double> values) { fields_[name] = std::move(values); }

  bool has_array(const std::string& name) const { return arrays_.contains(name); }
  /// The scalar, array or field of that name. References are valid until it is set again. Throws InputError
  /// if it is missing or of another type.
  int integer(const std::string& name) const;
  double number(const std::string& name) const;
  const std::string& text(const std::string& name) const;
  const std::vector<double>& array(const std::string& name) const;
  const std::vector<double>& field(const std::string& name) const;

  /// All scalars, arrays and fields by name.
  const std::map<std::string, Json>& scalars() const { return scalars_; }
  const std::map<std::string, std::vector<double>>& arrays() const { return arrays_; }
  const std::map<std::string, std::vector<double>>& fields() const { return fields_; }

 private:
  std::map<std::string, Json> scalars_;
  std::map<std::string, std::vector<double>> arrays_, fields_;
};

}  // namespace fabseq
