// SPDX-License-Identifier: MIT
#include "fabseq/files/process_mark.h"

#include "fabseq/base/plain_numbers.h"
#include "fabseq/base/posix_file.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <ctime>
#include <sstream>
#include <unistd.h>

namespace fabseq {

namespace {

/// Stands for a word that the system does not tell.
constexpr const char* unknown = "?";

std::string or_unknown(const std::string& word) { return word.empty() ? unknown : word; }

std::string host_name() {
  std::array<char, 256> host{};
  (void)::gethostname(host.data(), host.size() - 1);
  return or_unknown(host.data());
}

std::string time_now() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  (void)::gmtime_r(&now, &parts);
  std::array<char, 64> text{};
  (void)std::strftime(text.data(), text.size(), "%Y-%m-%d %H:%M:%S UTC", &parts);
  return text.data();
}

std::string boot_name() {
  std::string word;
  std::istringstream(read_file_if_there("/proc/sys/kernel/random/boot_id")) >> word;
  return or_unknown(word);
}

/// "pid:[4026531836]"
std::string container_name() {
  std::array<char, 64> text{};
  (void)!::readlink("/proc/self/ns/pid", text.data(), text.size() - 1);
  return or_unknown(text.data());
}

struct ProcessStatus {
  std::string state, start;  ///< "" if the system does not tell
};

/// The line of /proc/PID/stat has the name of the program in parentheses, of any characters; the next word is
/// the state, the 20th the start.
ProcessStatus status_of(int process) {
  const std::string line = read_file_if_there("/proc/" + std::to_string(process) + "/stat");
  const std::size_t name_end = line.rfind(')');
  ProcessStatus result;
  if (name_end == std::string::npos) return result;
  std::istringstream words(line.substr(name_end + 1));
  words >> result.state;
  for (int word = 2; word <= 20; ++word) words >> result.start;
  return result;
}

}  // namespace

ProcessMark ProcessMark::own() {
  ProcessMark mark;
  mark.host_ = host_name();
  mark.process_ = ::getpid();
  mark.boot_ = boot_name();
  mark.container_ = container_name();
  mark.start_ = or_unknown(status_of(mark.process_).start);
  mark.name_ = "host " + mark.host_ + ", since " + time_now() + ", process " + std::to_string(mark.process_);
  return mark;
}

std::string ProcessMark::text() const {
  return name_ + "\n" + host_ + " " + std::to_string(process_) + " " + boot_ + " " + container_ + " " +
         start_ + "\n";
}

std::optional<ProcessMark> ProcessMark::parse(const std::string& text) {
  std::istringstream stream(text);
  ProcessMark mark;
  std::string process;
  std::getline(stream, mark.name_);
  if (!(stream >> mark.host_ >> process >> mark.boot_ >> mark.container_ >> mark.start_)) return std::nullopt;
  mark.process_ = number_in<int>(process).value_or(0);
  return mark.process_ > 0 ? std::optional(mark) : std::nullopt;
}

std::optional<bool> ProcessMark::is_alive() const {
  if (boot_ == unknown || boot_ != boot_name()) return std::nullopt;
  if (container_ == unknown || container_ != container_name()) return std::nullopt;
  if (::kill(process_, 0) != 0 && errno == ESRCH) return false;
  const ProcessStatus now = status_of(process_);
  if (now.state.empty() || start_ == unknown) return true;      // the system hides the processes of others
  const bool has_ended = now.state == "Z" || now.state == "X";  // its parent has not asked for the status yet
  return !has_ended && now.start == start_;
}

bool ProcessMark::is_elsewhere() const { return boot_ != boot_name() && host_ != host_name(); }

}  // namespace fabseq
