// SPDX-License-Identifier: MIT
#include "fabseq/files/checkpoint.h"
#include "fabseq/files/seal.h"
#include "fabseq/parallel/layer_groups.h"
#include "fabseq/sequence/design_support.h"
#include "support/io_support.h"
#include "support/small_parts.h"

#include <cmath>
#include <fcntl.h>

namespace fabseq {
namespace {

using test::analytic_field;
using test::contains;
using test::error_text;
using test::file_text;
using test::is_first;

/// 7 x 3 x 5 elements of unequal edges in shares of different size, of which a corner is empty.
test::PartOnGrid<3> make_part(MPI_Comm comm = PETSC_COMM_WORLD) {
  const Domain<3> domain{{3.5, 0.6, 4.0}, {7, 3, 5}, 1.0};
  return test::PartOnGrid<3>(
      domain, test::union_of({test::box({0, 0, 0}, {2.0, 0.6, 4.0}), test::box({0, 0, 0}, {3.5, 0.6, 2.4})}),
      {2, false}, comm);
}

/// Two variables of each part element: shares of groups may end between them.
DesignSupport<3> support_of(const Part<3>& part) { return {part.grid(), false, part.elements(), 2}; }

/// Fields whose values tell iteration, element and component; in the void there are none.
std::vector<double> design_of(const Part<3>& part, int iteration) {
  std::vector<double> design =
      support_of(part).restrict_to_variables(analytic_field<3>(part.grid().owned_elements(), 2));
  for (double& value : design) value += iteration;
  return design;
}

/// Every rank has the entries of its part elements.
DesignLayout<3> layout_of(const Part<3>& part) {
  return {part.grid(), false, 2,
          [&part](std::span<const double> entries) { return support_of(part).expand(entries); },
          [&part](std::span<const double> field) { return support_of(part).restrict_to_variables(field); }};
}

/// Ranks with the same part elements share their entries.
DesignLayout<3> layout_of(const Part<3>& part, const LayerGroups& groups) {
  return {part.grid(), false, 2,
          [&](std::span<const double> share) { return support_of(part).expand(groups.gather(share)); },
          [&](std::span<const double> field) {
            return groups.share(support_of(part).restrict_to_variables(field));
          }};
}

CheckpointState state_of(const Part<3>& part, int iteration) {
  CheckpointState state;
  state.set_scalar("iteration", iteration);
  state.set_scalar("beta", 100.0 / 3.0);
  state.set_scalar("whole", 100.0);  // a number that must not come back as an integer
  state.set_scalar("converged", false);
  state.set_scalar("version", "0.1.0");
  state.set_array("first_values", {1.0 / 3.0, -0.0, 1e-300 * iteration});
  state.set_field("design", design_of(part, iteration));
  state.set_field("optimizer/last_design", design_of(part, -iteration));
  return state;
}

void expect_same(const CheckpointState& found, const CheckpointState& expected) {
  ASSERT_EQ(found.scalars().size(), expected.scalars().size());
  for (const auto& [name, value] : expected.scalars())
    EXPECT_EQ(found.scalars().at(name).dump(), value.dump());
  EXPECT_EQ(found.arrays(), expected.arrays());
  EXPECT_TRUE(std::signbit(found.array("first_values")[1]));
  EXPECT_EQ(found.fields(), expected.fields());
}

/// Checkpoints of states that tell their iteration.
class CheckpointedRun {
 public:
  explicit CheckpointedRun(const std::string& path)
      : directory_(PETSC_COMM_WORLD, path, false), whole_(make_part()) {}

  void checkpoint(int iteration) {
    write_checkpoint(directory_, layout_of(part()), state_of(part(), iteration));
  }
  const Part<3>& part() const { return whole_.part; }
  const std::string& path() const { return directory_.path(); }
  std::string file(const std::string& name) const { return directory_.file(name); }
  std::string newest() const { return newest_checkpoint(directory_.path()); }

  void expect_newest(int iteration, const std::string& slot) {
    MPI_Barrier(PETSC_COMM_WORLD);
    EXPECT_EQ(newest(), slot);
    EXPECT_EQ(find_checkpoint(PETSC_COMM_WORLD, path()), file(slot));
    expect_same(read_checkpoint(file(slot), layout_of(part())), state_of(part(), iteration));
    if (is_first()) {
      EXPECT_EQ(verify_checkpoint(file(slot)), 3);
    }
    MPI_Barrier(PETSC_COMM_WORLD);
  }

 private:
  OutputDirectory directory_;
  test::PartOnGrid<3> whole_;
};

/// Puts another text in the place of a slot, by rank 0.
void put(const std::string& path, const std::string& text) {
  MPI_Barrier(PETSC_COMM_WORLD);
  if (is_first()) std::ofstream(path, std::ios::binary) << text;
  MPI_Barrier(PETSC_COMM_WORLD);
}

std::string with_flipped_bit(std::string bytes, std::size_t place) {
  bytes[place] = static_cast<char>(bytes[place] ^ 4);
  return bytes;
}

TEST(Checkpoint, SlotsAlternate) {
  const test::ScratchDirectory scratch;
  CheckpointedRun run(scratch.path());
  EXPECT_EQ(run.newest(), "");
  for (int iteration = 1; iteration <= 5; ++iteration) {
    run.checkpoint(iteration);
    run.expect_newest(iteration, iteration % 2 == 1 ? "checkpoint/slot_0.h5" : "checkpoint/slot_1.h5");
  }
  if (is_first()) {
    EXPECT_EQ(file_text(run.file("checkpoint/newest")), "slot_0.h5\n");
  }
}

/// The checksum of all bytes of a slot: fixed, so the same on any number of ranks.
TEST(Checkpoint, FileDoesNotDependOnTheRanks) {
  const test::ScratchDirectory scratch;
  CheckpointedRun run(scratch.path());
  run.checkpoint(1);
  // The same written by one rank alone.
  if (!is_first()) return;
  const auto whole = make_part(PETSC_COMM_SELF);
  const OutputDirectory alone(PETSC_COMM_SELF, scratch.file("alone"), false);
  write_checkpoint(alone, layout_of(whole.part), state_of(whole.part, 1));
  EXPECT_EQ(file_text(run.file("checkpoint/slot_0.h5")), file_text(alone.file("checkpoint/slot_0.h5")));
  // And read by one rank alone.
  expect_same(read_checkpoint(run.file("checkpoint/slot_0.h5"), layout_of(whole.part)),
              state_of(whole.part, 1));
}

/// Every rank has a share of what its group has; the file is the same, and read by groups it is shared out
/// again.
TEST(Checkpoint, FileDoesNotDependOnTheGroups) {
  const test::ScratchDirectory scratch;
  CheckpointedRun run(scratch.path());
  run.checkpoint(1);
  for (int count = 2; count <= size_of(PETSC_COMM_WORLD); ++count) {
    if (size_of(PETSC_COMM_WORLD) % count != 0) continue;
    const LayerGroups groups(PETSC_COMM_WORLD, count);
    const auto whole = make_part(groups.domain());
    const CheckpointState state = state_of(whole.part, 1);
    CheckpointState shared = state;
    for (const auto& [name, field] : state.fields()) shared.set_field(name, groups.share(field));
    const DesignLayout<3> layout = layout_of(whole.part, groups);
    const OutputDirectory other(PETSC_COMM_WORLD, scratch.file("groups_" + std::to_string(count)), false);
    write_checkpoint(other, layout, shared);
    if (is_first()) {
      EXPECT_EQ(file_text(other.file("checkpoint/slot_0.h5")), file_text(run.file("checkpoint/slot_0.h5")));
    }
    expect_same(read_checkpoint(run.file("checkpoint/slot_0.h5"), layout), shared);
    MPI_Barrier(PETSC_COMM_WORLD);
  }
}

TEST(Checkpoint, ChecksumIsFnv1a) {
  Checksum checksum;
  EXPECT_EQ(checksum.value(), 0xcbf29ce484222325ULL);
  checksum.add("foo", 3);
  checksum.add("bar", 3);
  EXPECT_EQ(checksum.value(), 0x85944171f73967e8ULL);  // published for "foobar"
}

TEST(Checkpoint, ChecksumsFindDamage) {
  const test::ScratchDirectory scratch;
  CheckpointedRun run(scratch.path());
  run.checkpoint(1);
  if (!is_first()) return;
  const std::string path = run.file("checkpoint/slot_0.h5");
  const std::string intact = file_text(path);
  constexpr std::size_t seal_size = 16;
  const auto fault = [](const std::string& file) -> std::string {
    try {
      verify_checkpoint(file);
      return "nothing found";
    } catch (const OutputError& error) {
      return error.what();
    }
  };
  const auto damage_text = [&](const auto& pattern, const std::string& replacement) {
    std::string bytes = intact;
    const std::size_t place =
        bytes.find(std::string(reinterpret_cast<const char*>(&pattern), sizeof pattern));
    EXPECT_NE(place, std::string::npos);
    bytes.replace(place, replacement.size(), replacement);
    std::ofstream(path, std::ios::binary) << bytes;
    EXPECT_TRUE(contains(fault(path), "checksum of the file"));
    // Under a seal that is right, the checksums inside still find it.
    bytes.resize(bytes.size() - seal_size);
    std::ofstream(path, std::ios::binary) << bytes;
    seal_file(PosixFile(path, O_RDWR), static_cast<std::int64_t>(bytes.size()));
    return fault(path);
  };
  const double one_value = test::analytic<3>({3, 1, 2}, 0) + 1.0, beta = 100.0 / 3.0;
  EXPECT_TRUE(contains(damage_text(one_value, "X"), "dataset 'design'"));
  EXPECT_TRUE(contains(damage_text(beta, "X"), "scalars"));
  std::ofstream(path, std::ios::binary) << intact.substr(0, intact.size() / 2);
  EXPECT_THROW(verify_checkpoint(path), OutputError);
  std::ofstream(path, std::ios::binary) << intact;
  EXPECT_EQ(verify_checkpoint(path), 3);
}

/// Wherever a bit flips, in values or in what HDF5 itself has to make sense of, it is found.
TEST(Checkpoint, NoFlippedBitGoesUnnoticed) {
  const test::ScratchDirectory scratch;
  CheckpointedRun run(scratch.path());
  run.checkpoint(1);
  if (!is_first()) return;
  const std::string path = run.file("checkpoint/slot_0.h5");
  const std::string intact = file_text(path);
  for (std::size_t place = 0; place < intact.size(); place += 37) {
    std::ofstream(path, std::ios::binary) << with_flipped_bit(intact, place);
    EXPECT_THROW(verify_checkpoint(path), OutputError) << place;
  }
}

TEST(Checkpoint, TheOlderSlotIsUsedWhereTheNewestIsDamaged) {
  const test::ScratchDirectory scratch;
  CheckpointedRun run(scratch.path());
  run.checkpoint(1);
  run.checkpoint(2);
  const std::string newest = run.file("checkpoint/slot_1.h5"), older = run.file("checkpoint/slot_0.h5");
  const std::string intact = file_text(newest), intact_older = file_text(older);
  for (const std::string& damaged :
       {with_flipped_bit(intact, intact.size() / 3), intact.substr(0, 1000), std::string()}) {
    put(newest, damaged);
    testing::internal::CaptureStderr();
    const std::string found = find_checkpoint(PETSC_COMM_WORLD, run.path());
    const std::string warning = testing::internal::GetCapturedStderr();
    EXPECT_EQ(found, older);
    EXPECT_EQ(contains(warning, "slot_1.h5' is damaged") &&
                  contains(warning, "slot_0.h5', which is older, is used"),
              is_first())
        << warning;
    expect_same(read_checkpoint(found, layout_of(run.part())), state_of(run.part(), 1));
    put(older, "x");
    const std::string text = error_text<InputError>([&] { find_checkpoint(PETSC_COMM_WORLD, run.path()); });
    EXPECT_TRUE(contains(text, "slot_0.h5") && contains(text, "slot_1.h5")) << text;
    put(older, intact_older);
  }
}

TEST(Checkpoint, ARunThatEndedBeforeItsFirstPointer) {
  const test::ScratchDirectory scratch;
  EXPECT_EQ(find_checkpoint(PETSC_COMM_WORLD, scratch.path()), "");
  EXPECT_EQ(find_checkpoint(PETSC_COMM_WORLD, scratch.file("nothing")), "");
  CheckpointedRun run(scratch.path());
  run.checkpoint(1);
  if (is_first()) std::filesystem::remove(run.file("checkpoint/newest"));
  MPI_Barrier(PETSC_COMM_WORLD);
  EXPECT_EQ(find_checkpoint(PETSC_COMM_WORLD, run.path()), run.file("checkpoint/slot_0.h5"));
  put(run.file("checkpoint/slot_0.h5"), "half");
  testing::internal::CaptureStderr();
  EXPECT_EQ(find_checkpoint(PETSC_COMM_WORLD, run.path()), "");
  EXPECT_EQ(contains(testing::internal::GetCapturedStderr(), "damaged"), is_first());
}

TEST(CheckpointState, SaysWhatIsMissing) {
  CheckpointState state;
  state.set_scalar("number", 1.5);
  EXPECT_EQ(state.number("number"), 1.5);
  EXPECT_TRUE(contains(error_text<InputError>([&] { (void)state.integer("number"); }), "'number'"));
  EXPECT_TRUE(contains(error_text<InputError>([&] { (void)state.text("none"); }), "'none'"));
  EXPECT_TRUE(
      contains(error_text<InputError>([&] { (void)state.field("optimizer/low"); }), "'optimizer/low'"));
  EXPECT_THROW(state.set_scalar("x", std::nan("")), std::invalid_argument);
}

TEST(Checkpoint, AFailedSlotLeavesTheLastGoodOne) {
  // A slot takes some ten kilobytes; the third, written beside two good ones and a filler, finds no room.
  const test::SmallDisk disk("128k");
  if (!disk.mounted()) GTEST_SKIP() << "needs the privilege to mount a tmpfs";
  CheckpointedRun run(disk.path());
  run.checkpoint(1);
  run.checkpoint(2);
  put(disk.file("filler"), std::string(128 * 1024 - disk.used() - 4096, 'x'));
  const std::string text = error_text<OutputError>([&] { run.checkpoint(3); });
  EXPECT_TRUE(contains(text, "checkpoint/slot_0.h5")) << text;
  run.expect_newest(2, "checkpoint/slot_1.h5");
  if (is_first()) {
    EXPECT_EQ(verify_checkpoint(run.file("checkpoint/slot_0.h5")), 3);
    EXPECT_FALSE(std::filesystem::exists(run.file("checkpoint/slot_0.h5.partial")));
  }
}

}  // namespace
}  // namespace fabseq
