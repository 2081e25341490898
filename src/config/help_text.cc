// SPDX-License-Identifier: MIT
/// The table of config keys for users: -help and the reference in the manual.
#include "config/config_keys.h"
#include "fabseq/config/command_line.h"

#include <algorithm>
#include <sstream>
#include <utility>
#include <vector>

namespace fabseq {

namespace {

constexpr const char* usage =
    R"(fabseq: fabrication sequences for parts built by arc welding, optimized for little distortion.

Usage:
  fabseq -config FILE.json [-task TASK] [-output DIR] [-set path.to.key=VALUE]... [PETSc options]
  mpirun -np P fabseq -config FILE.json ...

Options:
  -config FILE.json      what to do: a JSON file, comments allowed, with the keys listed below
  -task TASK             optimize (default), simulate, sensitivity, evaluate, check_gradients, check (writes nothing),
                         surface (DIR/surface.ply: the part's mesh as it is read, in its place), or machine (prints
                         the config with what follows from its machine's file)
  -repair                with -task simulate and binary layers: mends the layers where they fail the machine's checks at few
                         places, and simulates them again
  -picture               with -task check: DIR/check.svg, a picture of elements, node sets, plate and first layers
  -output DIR            output directory (default: output/NAME)
  -overwrite             write into a directory that already holds a run
  -restart DIR           continue the run in DIR from its newest intact checkpoint, there or in -output; -restart auto
                         continues the run in the output directory, and starts one where there is none yet
  -max_wall_time TIME    stop after this time, in seconds or as H:M:S, with a checkpoint
  -design FILE.h5        design to start from, for every task but check, surface and machine: dataset design, as in result.h5
                         (missing: the initial values)
  -sequence FILE.h5      for -task simulate and sensitivity: the pseudo-time of this file (dataset time, as in
                         result.h5), cut into -layers N; as sharp as it was there, unless -beta or -binary are given
  -set path.to.key=VALUE sets a config key: VALUE is JSON, or else a string; entries of lists by index or type:
                         -set objective.1.weight=0.1, -set objective.layer_uniformity.weight=0.1
  -help, -version        print and end; -help_markdown: the keys as tables for the manual
All other options are PETSc's. Own options apply in the order given.

SIGUSR1, SIGUSR2, SIGTERM, SIGINT, SIGHUP, SIGXCPU, SIGPIPE and a file "stop" in the output directory end a run with
a checkpoint; a file "output_now" makes the next iteration write fields and a checkpoint.

Exit status: 0 done, 2 bad input, 3 numerical failure, 4 stopped, 5 output could not be written.
)";

/// Values that the key takes, with the dimension that it is restricted to.
std::string allowed_text(const ConfigKey& key) {
  if (key.type == KeyType::part) return "an object with one shape, voxels or a mesh";
  if (key.type == KeyType::node_sets) return "an object of named shapes";
  std::string text = allowed_values(key, 0);
  if (key.dimension != 0) text += " (only in " + std::to_string(key.dimension) + "D)";
  return text;
}

std::string default_text(const ConfigKey& key) {
  if (key.required) return "required";
  std::string text = key.default_value;
  if (!key.default_2d.empty()) text += ", in 2D " + key.default_2d;
  return text.empty() ? "none" : text;
}

std::string padded(const std::string& text, std::size_t width) {
  return text + std::string(text.size() < width ? width - text.size() : 1, ' ');
}

void write_flat_options(std::ostream& stream) {
  stream << "\nOptions for frequent keys (unit, default):\n";
  for (const ConfigKey* key : keys_with_option()) {
    const std::string unit = key->unit.empty() ? "" : key->unit + ", ";
    stream << "  " << padded(key->option, 24) << padded(dotted_path(*key), 42) << "(" << unit
           << default_text(*key) << ")\n";
  }
}

void write_key(std::ostream& stream, const ConfigKey& key) {
  const std::string name = key.variant.empty() ? key.name : key.variant + ": " + key.name;
  stream << "  " << padded(name, 34) << key.meaning << "\n" << std::string(36, ' ') << allowed_text(key);
  if (!key.unit.empty()) stream << " [" << key.unit << "]";
  stream << "; " << (key.required ? "" : "default ") << default_text(key) << "\n";
}

/// A text as code in Markdown.
std::string code(std::string_view text) { return text.empty() ? "" : "`" + std::string(text) + "`"; }

/// An item of a Markdown list, wrapped within 110 columns. Code is not broken, and no line begins with a ">".
void write_item(std::ostream& stream, const std::string& text) {
  constexpr std::size_t width = 110;
  std::string line = "-";
  for (std::size_t begin = 0, end = 0; begin < text.size(); begin = end + 1) {
    bool in_code = false;
    for (end = begin; end < text.size(); ++end) {
      in_code ^= text[end] == '`';
      if (text[end] == ' ' && !in_code && text[end + 1] != '>') break;
    }
    const std::string word = text.substr(begin, end - begin);
    if (line.size() + 1 + word.size() > width) {
      stream << line << "\n";
      line = " ";
    }
    line += " " + word;
  }
  stream << line << "\n";
}

/// "meaning. Default `...`; values [UNIT]; `-flat`." Sections have their own lists of keys.
std::string reference_text(const ConfigKey& key) {
  const bool section = key.type == KeyType::section, optional = section || default_text(key) == "none";
  std::string text = key.meaning + ". ";
  text += key.required ? "Required" : optional ? "Optional" : "Default " + code(key.default_value);
  if (!key.default_2d.empty()) text += ", in 2D " + code(key.default_2d);
  if (!section || key.dimension != 0) text += "; " + allowed_text(key);
  if (!key.unit.empty()) text += " [" + key.unit + "]";
  if (!key.option.empty()) text += "; " + code(key.option);
  return text + ".";
}

/// Keys of a section that differ by their variant at most.
struct ReferenceEntry {
  std::string names;     ///< as code, separated by commas
  std::string variants;  ///< likewise; empty: of all
  std::string text;

  bool operator==(const ReferenceEntry&) const = default;
};

void append(std::string& list, const std::string& word) { list += (list.empty() ? "" : ", ") + code(word); }

std::vector<ReferenceEntry> reference_entries(const SectionKeys& section) {
  std::vector<ReferenceEntry> result;
  for (const ConfigKey& key : section.keys) {
    ReferenceEntry entry{code(key.name), "", reference_text(key)};
    auto place = std::find_if(result.begin(), result.end(), [&](const ReferenceEntry& other) {
      return other.names == entry.names && other.text == entry.text;
    });
    if (place == result.end()) place = result.insert(result.end(), std::move(entry));
    if (!key.variant.empty()) append(place->variants, key.variant);
  }
  return result;
}

/// Replaces keys of a type that `earlier` declares word for word by one entry that refers to it.
void refer_to(const std::string& path, const std::vector<ReferenceEntry>& earlier,
              std::vector<ReferenceEntry>& entries) {
  std::vector<ReferenceEntry> result;
  for (ReferenceEntry& entry : entries) {
    if (entry.variants.empty() || std::find(earlier.begin(), earlier.end(), entry) == earlier.end()) {
      result.push_back(std::move(entry));
      continue;
    }
    const std::string text = "as in " + code(path) + ".";
    if (!result.empty() && result.back().text == text && result.back().variants == entry.variants)
      result.back().names += ", " + entry.names;
    else
      result.push_back({entry.names, entry.variants, text});
  }
  entries = std::move(result);
}

}  // namespace

std::string help_text() {
  std::ostringstream stream;
  stream << usage;
  write_flat_options(stream);
  stream << "\nConfig keys:\n";
  for (const SectionKeys& section : config_sections()) {
    stream << "\n" << (section.path.empty() ? "" : section.path + ": ") << section.title << "\n";
    for (const ConfigKey& key : section.keys) write_key(stream, key);
  }
  return stream.str();
}

std::string reference_table() {
  std::ostringstream stream;
  std::vector<ReferenceEntry> objective;
  for (const SectionKeys& section : config_sections()) {
    stream << "### " << (section.path.empty() ? "" : code(section.path) + ": ") << section.title << "\n\n";
    std::vector<ReferenceEntry> entries = reference_entries(section);
    if (section.path == "objective") objective = entries;
    if (section.path == "constraints") refer_to("objective", objective, entries);
    for (const ReferenceEntry& entry : entries) {
      const std::string variants = entry.variants.empty() ? "" : " (" + entry.variants + ")";
      write_item(stream, entry.names + variants + ": " + entry.text);
    }
    stream << "\n";
  }
  std::string text = stream.str();
  text.pop_back();  // the caller ends the last line
  return text;
}

}  // namespace fabseq
