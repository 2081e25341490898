#include "fabseq/base/hdf5.h"
#include "fabseq/io/checkpoint.h"
#include "fabseq/io/checksum.h"
#include "fabseq/io/hdf5_attribute.h"
#include "fabseq/io/hdf5_writer.h"

#include "support/io_support.h"

namespace fabseq {
namespace {

using test::analytic_field;
using test::contains;
using test::error_text;
using test::file_text;
using test::is_first;

Json scalars_of(int iteration) {
  return Json::object({{"iteration", Json(iteration)},
                       {"beta", Json(100.0 / 3.0)},
                       {"converged", Json(false)},
                       {"version", Json("0.1.0")}});
}

/// Checkpoints of a design that is `iteration` plus the analytic values.
class CheckpointedRun {
 public:
  CheckpointedRun(const std::string& path, Grid<3> grid)
      : directory_(PETSC_COMM_WORLD, path, false), grid_(std::move(grid)) {}

  void checkpoint(int iteration) {
    std::vector<double> design = analytic_field<3>(grid_.owned_elements(), 1);
    for (double& value : design) value += iteration;
    FieldSet<3> fields{&grid_, {}};
    fields.add_elements("design", design);
    fields.add_elements("optimizer/last_design", design);
    write_checkpoint(directory_, fields, scalars_of(iteration));
  }
  const Grid<3>& grid() const { return grid_; }
  std::string file(const std::string& name) const { return directory_.file(name); }
  std::string newest() const { return newest_checkpoint(directory_.path()); }

  void expect_newest(int iteration, const std::string& slot) {
    MPI_Barrier(PETSC_COMM_WORLD);
    EXPECT_EQ(newest(), slot);
    std::vector<double> design = analytic_field<3>(grid_.owned_elements(), 1);
    for (double& value : design) value += iteration;
    EXPECT_EQ(read_element_field(grid_, file(slot), "design"), design);
    if (is_first()) {
      EXPECT_EQ(verify_checkpoint(file(slot)), 2);
      const Hdf5File opened(H5Fopen(file(slot).c_str(), H5F_ACC_RDONLY, H5P_DEFAULT));
      const Json expected = scalars_of(iteration);
      for (const auto& [name, value] : expected.members())
        EXPECT_EQ(read_attribute(opened, name).value().dump(), value.dump()) << name;
    }
    MPI_Barrier(PETSC_COMM_WORLD);
  }

 private:
  OutputDirectory directory_;
  Grid<3> grid_;
};

TEST(Checkpoint, SlotsAlternate) {
  const test::ScratchDirectory scratch;
  CheckpointedRun run(scratch.path(), test::odd_grid<3>());
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
  CheckpointedRun run(scratch.path(), test::odd_grid<3>());
  run.checkpoint(1);
  // The same written by one rank alone from the analytic values.
  if (!is_first()) return;
  Domain<3> domain = run.grid().domain();
  const Grid<3> whole(PETSC_COMM_SELF, domain, {});
  std::vector<double> design = analytic_field<3>(whole.owned_elements(), 1);
  for (double& value : design) value += 1;
  FieldSet<3> fields{&whole, {}};
  fields.add_elements("design", design);
  fields.add_elements("optimizer/last_design", design);
  const OutputDirectory alone(PETSC_COMM_SELF, scratch.file("alone"), false);
  write_checkpoint(alone, fields, scalars_of(1));
  EXPECT_EQ(file_text(run.file("checkpoint/slot_0.h5")), file_text(alone.file("checkpoint/slot_0.h5")));
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
  CheckpointedRun run(scratch.path(), test::odd_grid<3>());
  run.checkpoint(1);
  if (!is_first()) return;
  const std::string path = run.file("checkpoint/slot_0.h5");
  const std::string intact = file_text(path);
  const auto damage_text = [&](const auto& pattern, const std::string& replacement) {
    std::string bytes = intact;
    const std::size_t place =
        bytes.find(std::string(reinterpret_cast<const char*>(&pattern), sizeof pattern));
    EXPECT_NE(place, std::string::npos);
    std::ofstream(path, std::ios::binary) << bytes.replace(place, replacement.size(), replacement);
    try {
      verify_checkpoint(path);
      return std::string("nothing found");
    } catch (const OutputError& error) {
      return std::string(error.what());
    }
  };
  const double one_value = test::analytic<3>({3, 1, 2}, 0) + 1.0, beta = 100.0 / 3.0;
  EXPECT_TRUE(contains(damage_text(one_value, "X"), "dataset 'design'"));
  EXPECT_TRUE(contains(damage_text(beta, "X"), "scalars"));
  std::ofstream(path, std::ios::binary) << intact.substr(0, intact.size() / 2);
  EXPECT_THROW(verify_checkpoint(path), OutputError);
  std::ofstream(path, std::ios::binary) << intact;
  EXPECT_EQ(verify_checkpoint(path), 2);
}

TEST(Checkpoint, AFailedSlotLeavesTheLastGoodOne) {
  // 24,000 elements twice: 384 kB a slot; the third, written beside two good ones, finds no room.
  const test::SmallDisk disk("1000k");
  if (!disk.mounted()) GTEST_SKIP() << "needs the privilege to mount a tmpfs";
  Domain<3> domain;
  domain.size = {1.0, 1.0, 1.0};
  domain.elements = {40, 20, 30};
  CheckpointedRun run(disk.path(), Grid<3>(PETSC_COMM_WORLD, domain, {}));
  run.checkpoint(1);
  run.checkpoint(2);
  const std::string text = error_text<OutputError>([&] { run.checkpoint(3); });
  EXPECT_TRUE(contains(text, "checkpoint/slot_0.h5")) << text;
  run.expect_newest(2, "checkpoint/slot_1.h5");
  if (is_first()) {
    EXPECT_EQ(verify_checkpoint(run.file("checkpoint/slot_0.h5")), 2);
    EXPECT_FALSE(std::filesystem::exists(run.file("checkpoint/slot_0.h5.partial")));
  }
}

}  // namespace
}  // namespace fabseq
