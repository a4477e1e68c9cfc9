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
