// Writes the files that the tests of this folder read.
#pragma once

#include "volmark/error.h"
#include "volmark/volume.h"
#include "volume/file_bytes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <sys/resource.h>
#include <vector>

namespace volmark::test {

/// A folder that is gone after the test.
class VolumeFiles : public testing::Test {
protected:
  VolumeFiles() {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    std::string name = std::string("volmark_") + info->test_suite_name() + "_" + info->name();
    std::replace(name.begin(), name.end(), '/', '_');
    m_folder = std::filesystem::path(testing::TempDir()) / name;
    std::filesystem::remove_all(m_folder);
    std::filesystem::create_directories(m_folder);
  }
  ~VolumeFiles() override { std::filesystem::remove_all(m_folder); }

  std::filesystem::path write(const std::string& name, const std::string& content) const {
    const std::filesystem::path path = m_folder / name;
    std::ofstream(path, std::ios::binary) << content;
    return path;
  }
  const std::filesystem::path& folder() const { return m_folder; }

private:
  std::filesystem::path m_folder;
};

/// Refusing takes neither time nor memory, here and in child processes. Other work on the machine doesn't count.
class Refusals : public VolumeFiles {
protected:
  Refusals() : m_seconds(seconds()), m_memory(usage(RUSAGE_SELF).ru_maxrss) {}
  ~Refusals() override {
    EXPECT_LT(seconds() - m_seconds, 1);
    EXPECT_LT(usage(RUSAGE_SELF).ru_maxrss - m_memory, kMoreKiB);
    EXPECT_LT(usage(RUSAGE_CHILDREN).ru_maxrss - m_memory, kMoreKiB);
  }
  /// A file that begins so and goes on with zeros, which take no disk space, up to `length`.
  std::filesystem::path writeSparse(const std::string& name, const std::string& start, std::uintmax_t length) const {
    const std::filesystem::path path = write(name, start);
    std::filesystem::resize_file(path, length);
    return path;
  }

private:
  static constexpr long kMoreKiB = 64 * 1024;

  static rusage usage(decltype(RUSAGE_SELF) who) {
    rusage result{};
    getrusage(who, &result);
    return result;
  }
  /// Of processors.
  static double seconds() {
    double sum = 0;
    for (const auto who : {RUSAGE_SELF, RUSAGE_CHILDREN})
      for (const timeval& time : {usage(who).ru_utime, usage(who).ru_stime})
        sum += static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
    return sum;
  }
  double m_seconds;
  long m_memory;
};

/// The scalars' bytes in one byte order.
template <class T> std::string encoded(const std::vector<T>& values, bool bigEndian) {
  std::string result;
  for (const T value : values) {
    char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    if (bigEndian != (std::endian::native == std::endian::big)) std::reverse(bytes, bytes + sizeof(T));
    result.append(bytes, sizeof(T));
  }
  return result;
}

/// Checks that `action` throws an InputError of one line that contains `part`.
template <class Action> void expectInputError(Action action, const std::string& part) {
  try {
    action();
    ADD_FAILURE() << "no InputError with \"" << part << "\"";
  } catch (const InputError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find(part), std::string::npos) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
    EXPECT_LT(text.size(), 600u) << text;
  }
}

} // namespace volmark::test
