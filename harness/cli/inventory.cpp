// volmark list, describe, device: what is here.
#include "cli/commands.h"
#include "scenario/scene_file.h"
#include "volmark/error.h"
#include "volmark/gpu/device.h"
#include "volmark/gpu/stamp_self_test.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>

namespace volmark {

namespace {

namespace fs = std::filesystem;

std::vector<fs::path> jsonFiles(const fs::path& folder, bool recursive) {
  std::vector<fs::path> files;
  std::error_code ignored;
  const auto take = [&](const fs::path& path) {
    if (path.extension() == ".json") files.push_back(path);
  };
  if (recursive)
    for (const auto& entry : fs::recursive_directory_iterator(folder, ignored))
      take(entry.path());
  else
    for (const auto& entry : fs::directory_iterator(folder, ignored))
      take(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

void listTechniques(const TechniqueCatalogue& catalogue) {
  fmt::print("techniques (volmark describe NAME):\n");
  for (const CatalogueEntry& entry : catalogue.entries())
    fmt::print("  {:<24} {}\n", entry.factory->info.name, entry.factory->info.summary);
  if (catalogue.entries().empty())
    fmt::print("  none; searched: {}\n", [] {
      std::vector<std::string> folders;
      for (const auto& folder : techniqueFolders())
        folders.push_back(folder.string());
      return fmt::format("{}", fmt::join(folders, ", "));
    }());
}

void listScenes(const Places& places, const DataFolders& data) {
  fmt::print("\nscenes ({}):\n", places.scenes.string());
  for (const fs::path& file : jsonFiles(places.scenes, false)) {
    try {
      const SceneDescription scene = readScene(file);
      const bool generated = std::holds_alternative<GeneratorSource>(scene.source);
      const bool here = generated || findVolumeFile(scene, data);
      const std::string state = generated                 ? "generated"
                                : here                    ? "here"
                                : scene.fetchHint.empty() ? "missing"
                                                          : "missing: " + scene.fetchHint;
      fmt::print("  {:<24} {} [{}]\n", scene.name, scene.title, state);
    } catch (const InputError& error) {
      fmt::print("  {:<24} unreadable: {}\n", file.stem().string(), error.what());
    }
  }
}

int list() {
  const Places places = findPlaces();
  listTechniques(loadCatalogue());
  listScenes(places, dataFolders({}, places));
  fmt::print("\nscenarios:\n");
  for (const fs::path& file : jsonFiles(places.configs, true)) {
    const std::string folder = file.parent_path().filename().string();
    if (folder != "profiles" && folder != "schema") fmt::print("  {}\n", file.string());
  }
  fmt::print("\nprofiles (--profile NAME):\n");
  for (const fs::path& file : jsonFiles(places.configs / "profiles", false))
    fmt::print("  {}\n", file.stem().string());
  return 0;
}

std::string valueText(const ParameterValue& value) {
  return std::visit([](const auto& v) -> std::string { return fmt::format("{}", v); }, value);
}

std::string rangeText(const ParameterDescriptor& parameter) {
  if (!parameter.choices.empty()) return fmt::format("{}", fmt::join(parameter.choices, " | "));
  if (!parameter.values.empty()) return fmt::format("{}", fmt::join(parameter.values, " | "));
  if (parameter.minimum && parameter.maximum)
    return fmt::format("{} to {} {}", *parameter.minimum, *parameter.maximum, parameter.unit);
  return std::string(typeNameOf(parameter.defaultValue));
}

void printPasses(const char* title, const std::vector<PassDescriptor>& passes) {
  if (passes.empty()) return;
  fmt::print("\n{}:\n", title);
  for (const PassDescriptor& pass : passes)
    fmt::print("  {:<24} {}\n", pass.name, pass.documentation);
}

std::string historyText(History history) {
  switch (history) {
  case History::none: return "none (a frame depends on its inputs alone)";
  case History::lossless: return "lossless (state is kept, the picture does not depend on it)";
  case History::visible: return "visible (the picture depends on earlier frames)";
  }
  return "";
}

std::string shadingText(const TechniqueInfo& info) {
  constexpr const char* names[] = {"none", "lambert", "phong", "gooch", "ggx"};
  std::vector<std::string> models;
  for (const ShadingModel model : info.shadings)
    models.emplace_back(names[static_cast<int>(model)]);
  return fmt::format("{}", fmt::join(models, ", "));
}

std::string layersText(const TechniqueInfo& info) {
  std::string text = "colour and distance";
  for (const PictureLayer layer : info.layers)
    text += layer == PictureLayer::normal ? ", normal (N)" : ", steps";
  return text;
}

int describe(const std::string& name) {
  const TechniqueCatalogue catalogue = loadCatalogue();
  const CatalogueEntry& entry = catalogue.get(name);
  const TechniqueInfo& info = entry.factory->info;
  constexpr const char* draws[] = {"isosurface", "volume", "isosurface and volume"};
  fmt::print("{}: {}\n", info.name, info.summary);
  if (!info.paper.empty()) fmt::print("  paper    {}, {}\n", info.paper, info.section);
  fmt::print("  family   {}\n  draws    {}\n  history  {}\n  runs on  {}\n  views    up to {}\n  shading  {}{}{}{}\n  "
             "layers   "
             "{}\n",
             entry.family, draws[static_cast<int>(info.draws)], historyText(info.history),
             info.needsGpu ? "a Vulkan device" : "the host alone", info.maximumViews, shadingText(info),
             info.shadows ? ", shadows" : "", info.functionBeyond ? ", beyond clipping planes" : "",
             info.segments ? ", segments" : "", layersText(info));
  fmt::print("\nparameters (technique.parameters.NAME):\n");
  for (const ParameterDescriptor& parameter : info.parameters)
    fmt::print("  {:<24} {}\n  {:<24}   default {}; {}\n", parameter.name, parameter.documentation, "",
               valueText(parameter.defaultValue), rangeText(parameter));
  if (info.parameters.empty()) fmt::print("  none\n");
  printPasses("passes of a frame", info.passes);
  printPasses("passes of generation", info.generation);
  constexpr const char* kinds[] = {"exact", "per device", "statistical"};
  if (!info.counters.empty()) fmt::print("\ncounters:\n");
  for (const CounterDescriptor& counter : info.counters)
    fmt::print("  {:<24} {} ({})\n", counter.name, counter.documentation, kinds[static_cast<int>(counter.kind)]);
  return 0;
}

void printDevice(const gpu::DeviceFacts& facts) {
  fmt::print("{}: {} ({}), {} {}, Vulkan {}\n", facts.index, facts.name, facts.type, facts.driverName, facts.driverInfo,
             facts.apiVersion);
  if (!facts.missing.empty()) fmt::print("   can't be used: {}\n", facts.missing);
  fmt::print(
      "   subgroups {} ({} to {}), 3-D images to {}, storage buffers to {} MiB, allocations to {} MiB, memory {} MiB\n",
      facts.subgroupSize, facts.minimumSubgroupSize, facts.maximumSubgroupSize, facts.maximumImageDimension3D,
      facts.maximumStorageBufferRange >> 20, facts.maximumAllocationBytes >> 20, facts.deviceMemoryBytes >> 20);
  const auto word = [](bool has) { return has ? "yes" : "no"; };
  fmt::print("   timestamps {}, mesh shaders {}, multiview {}, 64-bit buffer atomics {}, ray queries {}\n",
             facts.timestampPeriodNs > 0 ? fmt::format("{} ns", facts.timestampPeriodNs) : "no", word(facts.meshShader),
             word(facts.multiview), word(facts.int64BufferAtomics), word(facts.rayQuery));
}

int device(const std::string& selector, bool selfTest) {
  const auto devices = gpu::listDevices();
  if (devices.empty())
    throw DeviceError("no Vulkan device is here; ci/bootstrap.sh installs lavapipe, which runs on the CPU");
  for (const gpu::DeviceFacts& facts : devices)
    printDevice(facts);
  if (!selfTest) return 0;
  gpu::Device chosen(gpu::DeviceOptions{selector, false});
  const gpu::StampSelfTest test = gpu::runStampSelfTest(chosen);
  fmt::print("stamp self-test on {}: {}\n", chosen.facts().name, gpu::describe(test));
  return test.trusted ? 0 : 3;
}

} // namespace

void addListCommand(CLI::App& app, int& exitCode) {
  CLI::App* command = app.add_subcommand("list", "List techniques, scenes, scenarios and profiles");
  command->callback([&exitCode] { exitCode = list(); });
}

void addDescribeCommand(CLI::App& app, int& exitCode) {
  auto name = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand("describe", "Tell what a technique does, its parameters, passes and counters");
  command->add_option("TECHNIQUE", *name, "Name (volmark list)")->required();
  command->callback([name, &exitCode] { exitCode = describe(*name); });
}

void addDeviceCommand(CLI::App& app, int& exitCode) {
  auto selector = std::make_shared<std::string>();
  auto selfTest = std::make_shared<bool>(false);
  CLI::App* command = app.add_subcommand("device", "List Vulkan devices and what they can do");
  command->add_option("--device", *selector, "For the self-test: index or part of the name");
  command->add_flag("--self-test", *selfTest, "Check that timestamps tell passes apart (three draws of work 1:2:4)");
  command->callback([selector, selfTest, &exitCode] { exitCode = device(*selector, *selfTest); });
}

} // namespace volmark
