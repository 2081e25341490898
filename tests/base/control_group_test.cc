// SPDX-License-Identifier: MIT
/// Limits of control groups, in file systems made up for the test.
#include "base/control_group.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <unistd.h>

namespace fabseq {
namespace {

const std::string second_version = "30 23 0:26 / /sys/fs/cgroup rw,relatime shared:9 - cgroup2 cgroup2 rw\n";

class ControlGroupTest : public testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove_all(root); }

  void write(const std::string& path, const std::string& text) const {
    std::filesystem::create_directories(std::filesystem::path(root + path).parent_path());
    std::ofstream(root + path) << text;
  }
  void place(const std::string& groups, const std::string& mounts) const {
    write("/proc/self/cgroup", groups);
    write("/proc/self/mountinfo", "21 1 8:1 / / rw,relatime - ext4 /dev/sda1 rw\n" + mounts);
  }

  const std::string root =
      (std::filesystem::temp_directory_path() / ("fabseq_control_group_" + std::to_string(getpid())))
          .string();
};

TEST_F(ControlGroupTest, NoneWithoutFiles) {
  EXPECT_FALSE(cpu_quota(root));
  EXPECT_FALSE(memory_limit(root));
}

/// The root of a container with a name space of its own.
TEST_F(ControlGroupTest, AContainersOwnGroup) {
  place("0::/\n", second_version);
  write("/sys/fs/cgroup/cpu.max", "50000 100000\n");
  write("/sys/fs/cgroup/memory.max", "2000000000\n");
  write("/sys/fs/cgroup/memory.current", "900000000\n");
  write("/sys/fs/cgroup/memory.stat", "anon 100\nfile 7\ninactive_file 400000000\nactive_file 5\n");
  EXPECT_DOUBLE_EQ(cpu_quota(root).value_or(0.0), 0.5);
  const MemoryLimit limit = memory_limit(root).value_or(MemoryLimit{});
  EXPECT_EQ(limit.limit, 2000000000);
  EXPECT_EQ(limit.available, 1500000000);
}

/// A job's step below a job below a slice: each may have the tightest limit.
TEST_F(ControlGroupTest, TheTightestOfNestedGroupsCounts) {
  place("0::/slice/job/step\n", second_version);
  write("/sys/fs/cgroup/slice/cpu.max", "800000 100000\n");
  write("/sys/fs/cgroup/slice/job/cpu.max", "150000 100000\n");
  write("/sys/fs/cgroup/slice/job/step/cpu.max", "max 100000\n");
  write("/sys/fs/cgroup/slice/memory.max", "5000\n");
  write("/sys/fs/cgroup/slice/memory.current", "4000\n");
  write("/sys/fs/cgroup/slice/job/memory.max", "3000\n");
  write("/sys/fs/cgroup/slice/job/memory.current", "500\n");
  write("/sys/fs/cgroup/slice/job/step/memory.max", "max\n");
  EXPECT_EQ(ControlGroup("cpu", root).folders().size(), 4u);
  EXPECT_DOUBLE_EQ(cpu_quota(root).value_or(0.0), 1.5);
  EXPECT_EQ(memory_limit(root).value_or(MemoryLimit{}).limit, 3000);
  EXPECT_EQ(memory_limit(root).value_or(MemoryLimit{}).available, 1000);
}

TEST_F(ControlGroupTest, NoLimitIsNone) {
  place("0::/\n", second_version);
  write("/sys/fs/cgroup/cpu.max", "max 100000\n");
  write("/sys/fs/cgroup/memory.max", "max\n");
  EXPECT_FALSE(cpu_quota(root));
  EXPECT_FALSE(memory_limit(root));
}

/// Version 1, with a hierarchy of version 2 beside it that has no controllers. The container mounts its own
/// group, and has the path of the host.
TEST_F(ControlGroupTest, TheFirstVersion) {
  place("12:memory:/docker/a1\n4:cpu,cpuacct:/docker/a1\n1:name=systemd:/docker/a1\n0::/\n",
        "32 31 0:29 /docker/a1 /sys/fs/cgroup/cpu,cpuacct ro - cgroup cgroup rw,cpu,cpuacct\n"
        "33 31 0:30 /docker/a1 /sys/fs/cgroup/cpuset ro - cgroup cgroup rw,cpuset\n"
        "35 31 0:31 /docker/a1 /sys/fs/cgroup/memory ro - cgroup cgroup rw,memory\n"
        "41 31 0:38 / /sys/fs/cgroup/unified rw - cgroup2 cgroup2 rw\n");
  write("/sys/fs/cgroup/cpu,cpuacct/cpu.cfs_quota_us", "250000\n");
  write("/sys/fs/cgroup/cpu,cpuacct/cpu.cfs_period_us", "100000\n");
  write("/sys/fs/cgroup/memory/memory.limit_in_bytes", "9223372036854771712\n");
  EXPECT_FALSE(ControlGroup("cpu", root).unified());
  EXPECT_DOUBLE_EQ(cpu_quota(root).value_or(0.0), 2.5);
  EXPECT_FALSE(memory_limit(root));
  write("/sys/fs/cgroup/cpu,cpuacct/cpu.cfs_quota_us", "-1\n");
  EXPECT_FALSE(cpu_quota(root));
  write("/sys/fs/cgroup/memory/memory.limit_in_bytes", "1000\n");
  write("/sys/fs/cgroup/memory/memory.usage_in_bytes", "600\n");
  write("/sys/fs/cgroup/memory/memory.stat", "inactive_file 1\ntotal_inactive_file 100\n");
  EXPECT_EQ(memory_limit(root).value_or(MemoryLimit{}).available, 500);
}

TEST_F(ControlGroupTest, WhatMakesNoSenseIsNoLimit) {
  place("0::/../other\nnonsense\n", "30\n" + second_version);
  for (const char* text : {"", "0 100000\n", "50000\n", "50000 0\n", "many 100000\n"}) {
    write("/sys/fs/cgroup/cpu.max", text);
    EXPECT_FALSE(cpu_quota(root)) << text;
  }
  write("/sys/fs/cgroup/cpu.max", "100000 50000\n");
  EXPECT_DOUBLE_EQ(cpu_quota(root).value_or(0.0), 2.0);
}

}  // namespace
}  // namespace fabseq
