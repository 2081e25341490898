// SPDX-License-Identifier: MIT
#include "fabseq/config/command_line.h"

#include "config/config_keys.h"
#include "fabseq/base/error.h"
#include "fabseq/base/petsc.h"
#include "fabseq/base/stop.h"

#include <algorithm>
#include <cctype>
#include <span>
#include <string_view>

namespace fabseq {

namespace {

/// Names of the tasks, in the order of Task.
constexpr std::string_view task_names =
    "optimize simulate sensitivity evaluate check_gradients check surface machine";

/// Whether a word is an option ("-name"), not a negative number or a lone '-'; PETSc tells options from
/// values in the same way.
bool is_option(std::string_view word) {
  return word.size() > 1 && word[0] == '-' &&
         (std::isalpha(static_cast<unsigned char>(word[1])) != 0 || word[1] == '-');
}

/// Prefixes of the solvers' PETSc options, as stages.cc sets them, without the '_' at the end.
constexpr std::string_view solver_words = "elasticity heat release";

/// First words of PETSc's options: the prefixes of its classes and of its sub-solvers.
constexpr std::string_view petsc_words =
    "ao blas check_pointer_intensity checkstack citations cuda da debugger default_device_type "
    "device display dll dm draw error_output esteig fieldsplit fp_trap gamg get_total_flops hip "
    "history info is ksp log malloc mat memory mg mpi no_signal_handler nox objects_dump on_error "
    "options pc pf prefix python random redundant saws sf skip_petscrc snes splitreduction_async "
    "start_in_debugger stop_for_debugger sub tao ts use_gpu_aware_mpi vec vecscatter viewer x_virtual";

/// Whether PETSc or one of our solvers may know an option. PETSc keeps no list of its options, so this goes
/// by their first words.
bool begins_like_petscs(const std::string& option) {
  const auto known = [&](std::string_view words) {
    return std::ranges::any_of(split(words, ' '), [&](const std::string& word) {
      return (option + "_").starts_with("-" + word + "_");
    });
  };
  return known(solver_words) || known(petsc_words);
}

/// The option with each of the solvers' prefixes in place of its first word: for "-elastcity_ksp_view" these
/// are "-elasticity_ksp_view", "-heat_ksp_view", ...
std::vector<std::string> with_solver_prefixes(const std::string& word) {
  const std::size_t rest = word.find('_');
  if (rest == std::string::npos) return {};
  std::vector<std::string> result;
  for (const std::string& prefix : split(solver_words, ' '))
    result.push_back("-" + prefix + word.substr(rest));
  return result;
}

/// Whether PETSc has an option of this name.
bool is_petscs_too(std::string_view name) {
  return name == "-help" || name == "--help" || name == "-h" || name == "-version" || name == "--version";
}

Task parse_task(const std::string& name) {
  const std::vector<std::string> names = split(task_names, ' ');
  const auto found = std::ranges::find(names, name);
  if (found == names.end()) refuse("-task", shown(name), join(names, ", "));
  return static_cast<Task>(found - names.begin());
}

/// JSON text of a word that PETSc takes for a boolean, or of one of the key's words; empty for other words.
std::string boolean_value(const ConfigKey& key, const std::string& word) {
  const std::vector<std::string> words = split(key.words, ' ');
  if (std::ranges::find(words, word) != words.end()) return flat_option_value(key, word);
  if (word == "true" || word == "yes" || word == "on" || word == "1") return "true";
  if (word == "false" || word == "no" || word == "off" || word == "0") return "false";
  return "";
}

std::string quoted(const std::string& word) {
  const bool plain = !word.empty() && word.find_first_of(" \t\n\"'\\$*?[]{}()<>|&;#`") == std::string::npos;
  if (plain) return word;
  std::string result = "'";
  for (const char character : word)
    result += character == '\'' ? std::string("'\\''") : std::string(1, character);
  return result + "'";
}

class Parser {
 public:
  /// Names of all options that are not PETSc's.
  static std::vector<std::string> own_names() {
    std::vector<std::string> names;
    for (const ConfigKey* key : keys_with_option()) names.push_back(key->option);
    for (const OwnOption& option : own_options()) names.emplace_back(option.name);
    return names;
  }

  Parser(int argc, const char* const* argv) : words_(argv, argv + argc) {}

  CommandLine parse() {
    if (!words_.empty()) result_.petsc_arguments.push_back(words_.front());
    for (position_ = 1; position_ < words_.size(); ++position_) take(words_[position_]);
    for (const std::string& word : words_)
      result_.text.append(result_.text.empty() ? "" : " ").append(quoted(word));
    const bool only_prints = result_.help || result_.help_markdown || result_.version;
    if (result_.config_file.empty() && !only_prints) {
      throw InputError("-config: missing; allowed: -config FILE.json (-help lists all options)");
    }
    check_restart();
    check_sequence();
    if (result_.repair && result_.task != Task::simulate)
      throw InputError(
          "-repair: it mends the layers of what -task simulate simulates; allowed: with -task simulate");
    if (result_.picture && result_.task != Task::check)
      throw InputError("-picture: it is of what -task check checks; allowed: with -task check");
    return std::move(result_);
  }

 private:
  bool next_is_value() const { return position_ + 1 < words_.size() && !is_option(words_[position_ + 1]); }

  /// Takes the word after one of fabseq's own options as its value.
  const std::string& value(const std::string& option) {
    if (!next_is_value() || words_[position_ + 1].empty())
      throw InputError(option + ": missing value; allowed: " + option + " VALUE");
    return words_[++position_];
  }

  /// An option of fabseq's own, and the function that takes it and its value.
  struct OwnOption {
    std::string_view name;
    void (*take)(Parser& parser, const std::string& word);
  };
  static std::span<const OwnOption> own_options() {
    using Word = const std::string&;
    static constexpr OwnOption options[] = {
        {"-config", [](Parser& it, Word word) { it.result_.config_file = it.value(word); }},
        {"-task", [](Parser& it, Word word) { it.result_.task = parse_task(it.value(word)); }},
        {"-output", [](Parser& it, Word word) { it.result_.output = it.value(word); }},
        {"-design", [](Parser& it, Word word) { it.result_.design_file = it.value(word); }},
        {"-sequence", [](Parser& it, Word word) { it.result_.sequence_file = it.value(word); }},
        {"-restart", [](Parser& it, Word word) { it.result_.restart = it.value(word); }},
        {"-max_wall_time", [](Parser& it, Word word) { it.take_wall_time(it.value(word)); }},
        {"-repair", [](Parser& it, Word) { it.result_.repair = true; }},
        {"-picture", [](Parser& it, Word) { it.result_.picture = true; }},
        {"-overwrite", [](Parser& it, Word) { it.result_.overwrite = true; }},
        {"-help", [](Parser& it, Word) { it.result_.help = true; }},
        {"--help", [](Parser& it, Word) { it.result_.help = true; }},
        {"-h", [](Parser& it, Word) { it.result_.help = true; }},
        {"-help_markdown", [](Parser& it, Word) { it.result_.help_markdown = true; }},
        {"-version", [](Parser& it, Word) { it.result_.version = true; }},
        {"--version", [](Parser& it, Word) { it.result_.version = true; }},
        {"-set", [](Parser& it, Word word) { it.take_setting(it.value(word)); }}};
    return options;
  }

  void take(const std::string& word) {
    for (const OwnOption& option : own_options())
      if (option.name == word) return option.take(*this, word);
    for (const ConfigKey* key : keys_with_option())
      if (key->option == word) return take_flat_option(*key);
    pass_on(word);
  }

  void take_wall_time(const std::string& text) {
    result_.max_wall_time = parse_duration(text);
    if (!result_.max_wall_time) refuse("-max_wall_time", shown(text), "a time > 0 as seconds or H:M:S");
  }

  void check_restart() const {
    if (!result_.restart) return;
    if (result_.task != Task::optimize && result_.task != Task::check)
      throw InputError("-restart: only an optimization can be continued; allowed: with -task optimize");
    if (result_.overwrite &&
        (*result_.restart == "auto" || !result_.output || *result_.output == *result_.restart))
      throw InputError(
          "-restart: -overwrite would remove the checkpoint it is to continue from; allowed: one of "
          "the two, or another directory with -output");
  }

  void check_sequence() const {
    if (!result_.sequence_file) return;
    if (result_.task != Task::simulate && result_.task != Task::sensitivity && result_.task != Task::check)
      throw InputError(
          "-sequence: a given sequence is only simulated; allowed: with -task simulate or sensitivity");
    if (result_.design_file)
      throw InputError("-sequence: -design gives a sequence as well; allowed: one of the two");
  }

  void take_setting(const std::string& setting) {
    const std::size_t equals = setting.find('=');
    if (equals == std::string::npos || equals == 0) refuse("-set", shown(setting), "-set path.to.key=VALUE");
    result_.overrides.emplace_back(setting.substr(0, equals), setting.substr(equals + 1));
  }

  /// A flag without a value means true, as in PETSc.
  void take_flat_option(const ConfigKey& key) {
    if (key.type != KeyType::flag) {
      result_.overrides.emplace_back(dotted_path(key), flat_option_value(key, value(key.option)));
      return;
    }
    const std::string given = next_is_value() ? boolean_value(key, words_[position_ + 1]) : "";
    if (!given.empty()) ++position_;
    result_.overrides.emplace_back(dotted_path(key), given.empty() ? "true" : given);
  }

  /// Leaves an option to PETSc, which takes at most one value for it and would silently skip further words.
  void pass_on(const std::string& word) {
    if (!is_option(word)) {
      throw InputError(shown(word) + ": belongs to no option; allowed: options, each with at most one value");
    }
    refuse_misspelt(word);
    result_.petsc_arguments.push_back(word);
    if (next_is_value()) result_.petsc_arguments.push_back(words_[++position_]);
  }

  /// Refuses an option that nothing will read: better now than after hours of computing.
  static void refuse_misspelt(const std::string& word) {
    const std::vector<std::string> known = own_names();
    if (begins_like_petscs(word) && nearest_word(word, known, 2).empty()) return;
    std::string nearest = nearest_word(word, known);
    if (nearest.empty()) nearest = nearest_word(word, with_solver_prefixes(word), 2);
    throw InputError(word + ": unknown option; " +
                     (nearest.empty() ? "" : "did you mean \"" + nearest + "\"? ") +
                     "allowed: fabseq's options (-help lists them) and PETSc's");
  }

  std::vector<std::string> words_;
  std::size_t position_ = 0;
  CommandLine result_;
};

}  // namespace

CommandLine parse_command_line(int argc, const char* const* argv) { return Parser(argc, argv).parse(); }

void refuse_own_options_of_petsc() {
  for (const std::string& name : Parser::own_names()) {
    if (is_petscs_too(name)) continue;
    PetscBool given = PETSC_FALSE;
    check(PetscOptionsHasName(nullptr, nullptr, name.c_str(), &given));
    if (given != PETSC_FALSE)
      throw InputError(
          name +
          ": found in PETSC_OPTIONS, .petscrc or a file of PETSc's options, where fabseq does not "
          "look for it; allowed: on the command line, or its key in the config");
  }
}

}  // namespace fabseq
