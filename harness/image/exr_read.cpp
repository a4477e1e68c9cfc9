#include "image/exr.h"
#include "image/exr_channels.h"
#include "volmark/error.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <fmt/format.h>

namespace volmark {

namespace {

constexpr int kLargestSide = 65536;

/// The pictures that the header of a file of ours announces, with room for their layers. Throws std::runtime_error
/// if it isn't one.
std::vector<Picture> announced(const Imf::Header& header) {
  const auto* version = header.findTypedAttribute<Imf::IntAttribute>(exr::kFormatAttribute);
  if (!version) throw std::runtime_error(fmt::format("no attribute {}: not a picture of ours", exr::kFormatAttribute));
  if (version->value() != exr::kFormatVersion)
    throw std::runtime_error(
        fmt::format("{} is {}, allowed: {}", exr::kFormatAttribute, version->value(), exr::kFormatVersion));

  const Imath::Box2i& window = header.dataWindow();
  if (window.min != Imath::V2i(0) || window.max.x >= kLargestSide || window.max.y >= kLargestSide)
    throw std::runtime_error(fmt::format("data window from ({}, {}) to ({}, {}), allowed: from (0, 0), sides up to {}",
                                         window.min.x, window.min.y, window.max.x, window.max.y, kLargestSide));

  const std::size_t views = Imf::hasMultiView(header) ? Imf::multiView(header).size() : 1;
  if (views < 1 || views > 2) throw std::runtime_error(fmt::format("{} views, allowed: 1 or 2", views));

  // The library would fill absent channels with zeros.
  const auto require = [&](const std::string& name, Imf::PixelType type) {
    const Imf::Channel* channel = header.channels().findChannel(name);
    if (!channel) throw std::runtime_error(fmt::format("channel {} is missing", name));
    if (channel->type != type || channel->xSampling != 1 || channel->ySampling != 1)
      throw std::runtime_error(
          fmt::format("channel {} must be {} and not subsampled", name, type == Imf::HALF ? "half" : "float"));
  };
  for (std::size_t view = 0; view < views; ++view)
    for (const char* name : exr::kColorNames)
      require(exr::channelName(views, view, name), Imf::HALF);

  Picture picture(window.max.x + 1, window.max.y + 1);
  const auto has = [&](const char* name) {
    return header.channels().findChannel(exr::channelName(views, 0, name)) != nullptr;
  };
  if (!has(exr::kDistanceName)) picture.distance.clear();
  if (has(exr::kNormalNames[0])) picture.normal.resize(picture.color.size());
  if (has(exr::kStepsName)) picture.steps.resize(picture.color.size());
  for (std::size_t view = 0; view < views; ++view)
    for (const exr::FloatChannel& channel : exr::floatChannels(picture))
      require(exr::channelName(views, view, channel.name), Imf::FLOAT);
  return std::vector<Picture>(views, picture);
}

std::vector<Picture> readFile(const std::filesystem::path& path) {
  Imf::InputFile file(path.c_str());
  std::vector<Picture> pictures = announced(file.header());

  // Halves are widened on the way in.
  Imf::FrameBuffer frame;
  const auto width = static_cast<std::size_t>(pictures[0].width);
  for (std::size_t view = 0; view < pictures.size(); ++view) {
    Picture& picture = pictures[view];
    const auto insert = [&](const char* name, const float* first, std::size_t stride) {
      frame.insert(exr::channelName(pictures.size(), view, name),
                   Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(const_cast<float*>(first)), stride, stride * width));
    };
    for (int channel = 0; channel < 4; ++channel)
      insert(exr::kColorNames[static_cast<std::size_t>(channel)], &picture.color[0][channel], sizeof(glm::vec4));
    for (const exr::FloatChannel& channel : exr::floatChannels(picture))
      insert(channel.name, channel.first, channel.stride);
  }
  file.setFrameBuffer(frame);
  file.readPixels(0, pictures[0].height - 1);
  return pictures;
}

} // namespace

std::vector<Picture> readExr(const std::filesystem::path& path) {
  try {
    return readFile(path);
  } catch (const std::exception& error) {
    throw InputError(fmt::format("{}: picture can't be read: {}", path.string(), exr::oneLine(error.what())));
  }
}

} // namespace volmark
