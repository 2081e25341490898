// SPDX-License-Identifier: MIT
/// \file
/// The registry of findings. Each finding registers itself in its own source: what it measures of a sequence,
/// which record, cells of the printed table, fields and words it has.
#pragma once

#include "fabseq/report/build_fields.h"
#include "fabseq/report/found.h"
#include "fabseq/report/measured_sequence.h"

#include <initializer_list>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace fabseq {

/// What a finding is part of.
enum class MeasuredIn {
  checks,       ///< every check of layers, also without displacements, and every full report
  evaluations,  ///< every report, also of `-task evaluate`
  reports       ///< full reports, with the finished part
};

/// What is known of a finding before there is a sequence.
struct FindingTraits {
  std::string name;  ///< key of its sentences in `words` of summary.json
  int rank = 0;      ///< those of a smaller rank measure first, and stand first in records, fields and words
  MeasuredIn measured_in = MeasuredIn::reports;
};

/// What has been measured of a sequence.
struct BuildReport {
  Found numbers;
  BuildFields fields;
};

/// A type of finding.
class Finding : public FindingTraits {
 public:
  explicit Finding(FindingTraits traits) : FindingTraits(std::move(traits)) {}
  Finding(const Finding&) = delete;
  Finding& operator=(const Finding&) = delete;
  virtual ~Finding() = default;

  /// Adds what it finds to the report. Collective.
  virtual void measure(const MeasuredSequence<2>& sequence, BuildReport& report) const = 0;
  virtual void measure(const MeasuredSequence<3>& sequence, BuildReport& report) const = 0;
};

/// All findings, those of a smaller rank first. They live as long as the program.
std::vector<const Finding*> findings();
/// Adds a finding, which must live as long as the program. RegisteredFinding calls it.
void register_finding(const Finding* finding);
/// Measures what belongs to any of these. Collective.
template <int Dim>
void measure_findings(const MeasuredSequence<Dim>& sequence, std::initializer_list<MeasuredIn> what,
                      BuildReport& report);

/// Registers a finding. The finding's source defines one object of this type.
///   - Kind: with a static function template measure<Dim>(const MeasuredSequence<Dim>&, BuildFields&), which
///     adds the fields and returns the numbers, a std::optional of a class derived from FoundNumbers. None:
///     there is nothing to tell of this sequence. Collective, with the same answer on all ranks.
template <class Kind>
class RegisteredFinding : public Finding {
 public:
  explicit RegisteredFinding(FindingTraits traits) : Finding(std::move(traits)) { register_finding(this); }

  void measure(const MeasuredSequence<2>& sequence, BuildReport& report) const override {
    measure_kind(sequence, report);
  }
  void measure(const MeasuredSequence<3>& sequence, BuildReport& report) const override {
    measure_kind(sequence, report);
  }

 private:
  template <int Dim>
  void measure_kind(const MeasuredSequence<Dim>& sequence, BuildReport& report) const {
    auto numbers = Kind::template measure<Dim>(sequence, report.fields);
    if (!numbers) return;
    using Numbers = typename decltype(numbers)::value_type;
    report.numbers.add(name, std::make_shared<const Numbers>(*std::move(numbers)));
  }
};

}  // namespace fabseq
