// SPDX-License-Identifier: MIT
/// Sequences of type "file" (docs/formulation.md 3.1).
#include "fabseq/sequence/given_sequence.h"
#include "fabseq/sequence/sequence_kind.h"

namespace fabseq {

namespace {

struct FileKind {
  using Settings = FileSettings;

  static Section<Settings> keys() {
    return Section<Settings>("sequence")
        .key("file", &Settings::file, "HDF5 file with the pseudo-time",
             {.type = KeyType::path, .required = true})
        .key("dataset", &Settings::dataset,
             "Dataset with axes [z][y][x], values in [0, 1]; with a gradient beside it any");
  }

  static SequenceFacts facts(const Settings& settings) {
    return {.gradient_obstacle = "type \"file\"", .files = {{"file", settings.file}}};
  }

  template <int Dim>
  static std::unique_ptr<Sequence<Dim>> make(const Settings& settings, const SequenceContext<Dim>& context) {
    return std::make_unique<GivenSequence<Dim>>(
        time_from_file(context.part, settings.file, settings.dataset));
  }
};

const RegisteredSequence<FileKind> registered({.name = "file", .position = 4});

}  // namespace

}  // namespace fabseq
