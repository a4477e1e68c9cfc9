#include "image/exr.h"
#include "image/exr_channels.h"
#include "volmark/error.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <fmt/format.h>

#include <cassert>
#include <unistd.h>

namespace volmark {

namespace {

/// Rows and columns swapped: OpenEXR's matrices stand to the right of the vector.
Imath::M44f forRowVectors(const glm::dmat4& matrix) {
  Imath::M44f result;
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row)
      result[column][row] = static_cast<float>(matrix[column][row]);
  return result;
}

/// From the rows of a matrix that stands to the left of the vector.
glm::dmat4 fromRows(const glm::dvec4& x, const glm::dvec4& y, const glm::dvec4& z, const glm::dvec4& w) {
  return glm::transpose(glm::dmat4(x, y, z, w));
}

glm::dmat4 worldToCamera(const Pose& pose) {
  const auto row = [&](const glm::dvec3& axis) { return glm::dvec4(axis, -glm::dot(axis, pose.position)); };
  return fromRows(row(pose.right), row(pose.up), row(pose.forward), {0, 0, 0, 1});
}

glm::dmat4 worldToNdc(const View& view) {
  // x = (X/Z - left) / (right - left), y = (up - Y/Z) / (up - down), both times w = Z.
  const Frustum& f = view.frustum;
  const double width = f.right - f.left;
  const double height = f.up - f.down;
  const glm::dmat4 project =
      fromRows({1 / width, 0, -f.left / width, 0}, {0, -1 / height, f.up / height, 0}, {0, 0, 0, 1}, {0, 0, 1, 0});
  return project * worldToCamera(view.pose);
}

Imf::Header headerOf(const std::vector<Picture>& pictures, const ExrAttributes& attributes) {
  Imf::Header header(pictures[0].width, pictures[0].height);
  header.compression() = Imf::ZIP_COMPRESSION;
  for (std::size_t view = 0; view < pictures.size(); ++view) {
    for (const char* name : exr::kColorNames)
      header.channels().insert(exr::channelName(pictures.size(), view, name), Imf::Channel(Imf::HALF));
    for (const exr::FloatChannel& channel : exr::floatChannels(pictures[view]))
      header.channels().insert(exr::channelName(pictures.size(), view, channel.name), Imf::Channel(Imf::FLOAT));
  }

  if (pictures.size() == 2) Imf::addMultiView(header, exr::kViewNames);
  header.insert(exr::kFormatAttribute, Imf::IntAttribute(exr::kFormatVersion));
  if (!attributes.run.empty()) header.insert("volmark.run", Imf::StringAttribute(attributes.run));
  if (!attributes.comments.empty()) Imf::addComments(header, attributes.comments);
  for (std::size_t view = 0; view < attributes.views.size(); ++view) {
    const Imf::M44fAttribute toCamera(forRowVectors(worldToCamera(attributes.views[view].pose)));
    const Imf::M44fAttribute toNdc(forRowVectors(worldToNdc(attributes.views[view])));
    const std::string prefix = view == 0 ? "" : "right.";
    header.insert(prefix + "worldToCamera", toCamera);
    header.insert(prefix + "worldToNDC", toNdc);
  }
  return header;
}

/// Four halves a pixel, row-major.
std::vector<half> halves(const Picture& picture) {
  std::vector<half> result;
  result.reserve(picture.color.size() * 4);
  for (const glm::vec4& color : picture.color)
    for (int channel = 0; channel < 4; ++channel)
      result.emplace_back(color[channel]);
  return result;
}

void writeFile(const std::filesystem::path& path, const std::vector<Picture>& pictures,
               const ExrAttributes& attributes) {
  std::vector<std::vector<half>> colors;
  for (const Picture& picture : pictures)
    colors.push_back(halves(picture));

  Imf::FrameBuffer frame;
  const auto width = static_cast<std::size_t>(pictures[0].width);
  for (std::size_t view = 0; view < pictures.size(); ++view) {
    for (std::size_t channel = 0; channel < 4; ++channel)
      frame.insert(exr::channelName(pictures.size(), view, exr::kColorNames[channel]),
                   Imf::Slice(Imf::HALF, reinterpret_cast<char*>(colors[view].data() + channel), 4 * sizeof(half),
                              4 * sizeof(half) * width));
    // The library's slices are not const, but writing only reads them.
    for (const exr::FloatChannel& channel : exr::floatChannels(pictures[view]))
      frame.insert(exr::channelName(pictures.size(), view, channel.name),
                   Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(const_cast<float*>(channel.first)), channel.stride,
                              channel.stride * width));
  }

  Imf::OutputFile file(path.c_str(), headerOf(pictures, attributes));
  file.setFrameBuffer(frame);
  file.writePixels(pictures[0].height);
}

} // namespace

void writeExr(const std::filesystem::path& path, const std::vector<Picture>& pictures,
              const ExrAttributes& attributes) {
  assert(pictures.size() == 1 || pictures.size() == 2);
  assert(attributes.views.empty() || attributes.views.size() == pictures.size());
  for ([[maybe_unused]] const Picture& picture : pictures) {
    assert(picture.width == pictures[0].width && picture.height == pictures[0].height && picture.width > 0);
    assert(picture.distance.size() == pictures[0].distance.size());
    assert(picture.normal.size() == pictures[0].normal.size() && picture.steps.size() == pictures[0].steps.size());
  }

  // Workers may write the same picture at the same time: each has its own temporary name.
  std::filesystem::path temporary = path;
  temporary += fmt::format(".{}.partial", getpid());
  try {
    writeFile(temporary, pictures, attributes);
    std::filesystem::rename(temporary, path);
  } catch (const std::exception& error) {
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    throw InputError(fmt::format("{}: picture can't be written: {}", path.string(), exr::oneLine(error.what())));
  }
}

} // namespace volmark
