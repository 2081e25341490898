// SPDX-License-Identifier: MIT
/// Reads a machine file: finds it, checks that each entry has a source, and reads the entries.
#include "config/config_keys.h"
#include "config/machine_defaults.h"
#include "config/named_files.h"
#include "config/named_json.h"
#include "fabseq/base/mpi.h"
#include "fabseq/base/refusal.h"
#include "fabseq/base/run_program.h"
#include "fabseq/base/verdict.h"

#include <algorithm>
#include <filesystem>
#include <vector>

namespace fabseq {

namespace {

namespace fs = std::filesystem;

constexpr const char* pointer = "/machine";
constexpr const char* extension = ".json";
constexpr const char* of_entry = "an object with value, unit (if it has one) and source";

/// The folder configs/machines of the source tree or the installation; "" where there is none.
fs::path folder_of_machines() {
  const std::string tools = find_tools();
  if (tools.empty()) return "";
  std::error_code error;
  const fs::path scripts = fs::canonical(tools, error).parent_path();
  return error ? "" : scripts.parent_path() / "configs" / "machines";
}

/// Names of the machines in the folder, sorted.
std::vector<std::string> machines_in(const fs::path& folder) {
  std::vector<std::string> result;
  std::error_code error;
  for (const auto& file : fs::directory_iterator(folder, error))
    if (file.path().extension() == extension) result.push_back(file.path().filename().string());
  std::sort(result.begin(), result.end());
  return result;
}

/// Path of the file that the key names: relative to the config's directory, or else in configs/machines,
/// where .json may be left out. Throws InputError.
std::string find_machine(const std::string& name, const std::string& directory) {
  const fs::path beside = (fs::path(directory) / name).lexically_normal();
  std::error_code error;
  if (fs::exists(beside, error)) return beside.string();
  const fs::path folder = folder_of_machines();
  for (const std::string& file : machines_in(folder))
    if (file == name || file == name + extension) return (folder / file).string();
  const std::string known = join(machines_in(folder), ", ");
  refuse(pointer, shown(name) + ", and no " + shown(beside.string()),
         "a file beside the config" + (known.empty() ? "" : ", or one of " + known));
}

bool is_text(const Json* value) {
  return value != nullptr && value->is_string() && !value->get_ref<const std::string&>().empty();
}

/// Value of an entry. `place`: of the entry, for messages; `unit`: that it is in, or "".
Json value_of(const Json& entry, const std::string& place, const std::string& unit) {
  const Json* value = find_member(entry, "value");
  if (value == nullptr) refuse(place, shown(entry), of_entry);
  for (const auto& [name, member] : entry.items())
    if (name != "value" && name != "unit" && name != "source")
      refuse(place, "a key " + shown(name), of_entry);
  if (!is_text(find_member(entry, "source")))
    refuse(place, "no source", "source: title and address of what says so, or \"assumed\"");
  const Json* given = find_member(entry, "unit");
  if (unit.empty() ? given != nullptr : given == nullptr || *given != unit)
    refuse(pointer_to(place, "unit"), given == nullptr ? "none" : shown(*given),
           unit.empty() ? "none" : shown(unit));
  return *value;
}

/// The values of the entries that have a source, and the texts. `place`: of the file, for messages.
Json values_of(const Json& file, const std::string& place) {
  const std::vector<ConfigKey> keys = machine_entries().declarations().front().keys;
  Json result = Json::object();
  for (const auto& [name, entry] : file.items()) {
    const auto key = std::find_if(keys.begin(), keys.end(),
                                  [&name = name](const ConfigKey& one) { return one.name == name; });
    const bool is_entry = key != keys.end() && name != "name" && name != "comment";
    result[name] = is_entry ? value_of(entry, pointer_to(place, name), key->unit) : entry;
  }
  return result;
}

MachineEntries read_machine(MPI_Comm comm, const std::string& path) {
  constexpr int dimension = 3;  // of the machine, which any part may be built on
  const std::string place = path + ": ";
  const Json values = values_of(read_named_json(comm, pointer, path), place);
  MachineEntries result;
  machine_entries().read(result, complete_section(values, place, "machine", dimension, ""),
                         {place, dimension});
  return result;
}

}  // namespace

void merge_machine_file(MPI_Comm comm, Json& document, const std::string& directory) {
  const Json* file = find_member(document, "machine");
  if (file == nullptr) return;
  if (!is_text(file)) refuse(pointer, shown(*file), "a file name");
  std::string path;
  run_on_first(comm, [&] { path = find_machine(file->get<std::string>(), directory); });
  const MachineEntries machine = read_machine(comm, broadcast(comm, path));
  document.erase("machine");
  add_machine_defaults(machine, document);
}

}  // namespace fabseq
