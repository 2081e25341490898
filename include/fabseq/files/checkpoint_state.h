// SPDX-License-Identifier: MIT
#pragma once

#include "fabseq/base/json.h"

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace fabseq {

/// What a run carries from one iteration to the next, as named scalars, arrays and fields of the design:
/// every class that has some of it adds its own to a state, and takes it back from one. Names may have groups
/// ("optimizer/low"). Reading what is not there throws InputError, on all ranks since all have the same
/// names: the checkpoint was written by another version.
class CheckpointState {
 public:
  /// A boolean, integer, finite number or string, the same on all ranks.
  void set_scalar(const std::string& name, Json value);
  /// Finite numbers, the same on all ranks.
  void set_array(const std::string& name, std::vector<double> values);
  /// An entry for each of this rank's design variables. Read on another number of ranks, or shared by them in
  /// another way, it comes back distributed like theirs.
  void set_field(const std::string& name, std::vector<double> values) { fields_[name] = std::move(values); }

  bool has_array(const std::string& name) const { return arrays_.contains(name); }
  int integer(const std::string& name) const;
  double number(const std::string& name) const;
  const std::string& text(const std::string& name) const;
  const std::vector<double>& array(const std::string& name) const;
  const std::vector<double>& field(const std::string& name) const;

  /// Everything, by name.
  const std::map<std::string, Json>& scalars() const { return scalars_; }
  const std::map<std::string, std::vector<double>>& arrays() const { return arrays_; }
  const std::map<std::string, std::vector<double>>& fields() const { return fields_; }

 private:
  const Json& scalar(const std::string& name) const;

  std::map<std::string, Json> scalars_;
  std::map<std::string, std::vector<double>> arrays_, fields_;
};

}  // namespace fabseq
