// Bytes of small volume files, for the tests, the fuzz targets and the microbenchmarks.
#pragma once

#include <glm/glm.hpp>
#include <zlib.h>

#include <cstdint>
#include <cstring>
#include <string>

namespace volmark::test {

inline std::string gzipped(const std::string& text) {
  z_stream stream{};
  deflateInit2(&stream, 6, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY);
  std::string result(deflateBound(&stream, text.size()) + 32, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
  stream.avail_in = static_cast<uInt>(text.size());
  stream.next_out = reinterpret_cast<Bytef*>(result.data());
  stream.avail_out = static_cast<uInt>(result.size());
  deflate(&stream, Z_FINISH);
  result.resize(stream.total_out);
  deflateEnd(&stream);
  return result;
}

/// NIfTI-1 up to the first voxel: 352 bytes in this machine's byte order, spacing 1. `datatype`: 2 uint8, 4 int16.
inline std::string niftiHeader(const glm::ivec3& dims, int datatype) {
  std::string bytes(352, '\0');
  const auto put = [&]<class T>(std::size_t place, T value) { std::memcpy(bytes.data() + place, &value, sizeof(T)); };
  put(0, std::int32_t(348));
  put(40, std::int16_t(3));
  for (int axis = 0; axis < 3; ++axis) {
    put(42 + 2 * static_cast<std::size_t>(axis), static_cast<std::int16_t>(dims[axis]));
    put(80 + 4 * static_cast<std::size_t>(axis), 1.0F);
  }
  put(70, static_cast<std::int16_t>(datatype));
  put(72, static_cast<std::int16_t>(datatype == 2 ? 8 : 16));
  put(108, 352.0F);
  bytes.replace(344, 3, "n+1");
  return bytes;
}

} // namespace volmark::test
