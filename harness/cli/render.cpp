// volmark render: one picture.
#include "cli/commands.h"
#include "image/exr.h"
#include "reference/reference.h"
#include "scenario/scenario.h"
#include "surface/write_mesh.h"
#include "volmark/error.h"
#include "worker/session.h"

#include <fmt/format.h>

#include <memory>
#include <regex>

namespace volmark {

namespace {

struct RenderArguments {
  std::string volume;
  std::string scene;
  std::string technique = "iso_raymarch";
  double isovalue = -1;
  std::string transferFunction;
  std::string size = "512x512";
  double phase = 0;
  bool stereo = false;
  bool reference = false;
  std::vector<std::string> assignments;
  std::vector<std::string> data;
  std::string device;
  bool validate = false;
  double maximumGib = kDefaultMaximumGib;
  std::string output;
  std::string mesh;
};

nlohmann::json parseSize(const std::string& text) {
  std::smatch match;
  if (!std::regex_match(text, match, std::regex(R"((\d{1,5})x(\d{1,5}))")))
    throw InputError(fmt::format("--size: found \"{}\", allowed: WIDTHxHEIGHT, as in 512x512", text));
  return {std::stoi(match[1]), std::stoi(match[2])};
}

nlohmann::json settingsOf(const RenderArguments& arguments) {
  nlohmann::json set{{"technique.name", arguments.technique}, {"resolution", parseSize(arguments.size)}};
  set["scene"] = arguments.volume.empty() ? arguments.scene : arguments.volume;
  if (arguments.isovalue >= 0) set["isovalue"] = {{"normalized", arguments.isovalue}};
  if (!arguments.transferFunction.empty()) set["transfer_function"] = arguments.transferFunction;
  if (arguments.stereo) set["stereo.enabled"] = true;
  return set;
}

std::vector<Picture> drawReference(const PointSettings& settings, const Scene& scene, Draws draws, double phase) {
  const FrameInputs inputs = Timeline(settings, scene).at(phase);
  std::vector<Picture> pictures;
  for (int view = 0; view < static_cast<int>(inputs.views.size()); ++view)
    pictures.push_back(draws == Draws::volume
                           ? reference::renderVolume(scene, inputs, view, settings.width, settings.height, {})
                           : reference::renderIsosurface(scene, inputs, view, settings.width, settings.height));
  return pictures;
}

void exportMesh(const RenderArguments& arguments, Session& session) {
  const std::optional<SurfaceMesh> mesh = session.technique().surface();
  if (!mesh)
    throw InputError(fmt::format("--mesh: the technique {} makes no mesh; marching_cubes and optimized_mesh do",
                                 arguments.technique));
  writeMesh(arguments.mesh, *mesh, fmt::format("volmark {} {}", arguments.technique, session.settings().sceneName));
  fmt::print("{}: {} vertices, {} triangles\n", arguments.mesh, mesh->positions.size(), mesh->triangles.size());
}

int render(const RenderArguments& arguments) {
  if (arguments.volume.empty() == arguments.scene.empty())
    throw InputError("render: give either --volume FILE or --scene NAME (volmark list shows the scenes)");
  if (!arguments.mesh.empty()) requireMeshEnding(arguments.mesh);
  if (!arguments.mesh.empty() && arguments.reference)
    throw InputError("--mesh: the reference makes no mesh; leave --reference out");
  const Places places = findPlaces();
  const TechniqueCatalogue catalogue = loadCatalogue();
  const Point point = makePoint(settingsOf(arguments), arguments.assignments, catalogue, places.scenes);
  const PointSettings& settings = point.settings;
  const CatalogueEntry& entry = catalogue.get(settings.technique);
  auto volume = openVolume(settings.scene, dataFolders(arguments.data, places), bytesOfGib(arguments.maximumGib));

  std::vector<Picture> pictures;
  std::string time;
  if (arguments.reference) {
    pictures = drawReference(settings, makeScene(settings, volume), entry.factory->info.draws, arguments.phase);
  } else {
    Session session(settings, entry, volume, {arguments.device, arguments.validate});
    session.prepare();
    session.reset();
    session.draw(arguments.phase, 0, StampMode::headline); // the first use of a pipeline compiles it
    session.reset();
    const CompletedFrame frame = session.draw(arguments.phase, 0, StampMode::headline);
    pictures = session.pictures();
    if (!session.info().layers.empty()) {
      session.reset();
      session.draw(arguments.phase, 0, StampMode::headline, true);
      session.addLayers(pictures);
    }
    time = fmt::format(", {:.1f} ms", frame.endMs - frame.startMs);
    if (!arguments.mesh.empty()) exportMesh(arguments, session);
    if (session.device())
      for (const std::string& message : session.device()->validationMessages())
        fmt::print(stderr, "validation: {}\n", message);
  }
  ExrAttributes attributes;
  attributes.comments =
      fmt::format("volmark {} {}", arguments.reference ? "reference" : settings.technique, settings.sceneName);
  attributes.views = Timeline(settings, makeScene(settings, volume)).at(arguments.phase).views;
  writeExr(arguments.output, pictures, attributes);
  fmt::print("{}: {} x {}{}\n", arguments.output, settings.width, settings.height, time);
  return 0;
}

} // namespace

void addRenderCommand(CLI::App& app, int& exitCode) {
  auto arguments = std::make_shared<RenderArguments>();
  CLI::App* command = app.add_subcommand("render", "Draw one picture");
  command->add_option("--volume", arguments->volume,
                      "Volume file (volmark info --help lists formats), or a folder with a DICOM series");
  command->add_option("--scene", arguments->scene, "Scene name or file, instead of --volume");
  command->add_option("--technique", arguments->technique, "Technique (volmark list)")->capture_default_str();
  command->add_option("--isovalue", arguments->isovalue, "Normalised isovalue; default: the scene's first")
      ->check(CLI::Range(0.0, 1.0));
  command->add_option("--transfer-function", arguments->transferFunction, "Name of one of the scene's");
  command->add_option("--size", arguments->size, "WIDTHxHEIGHT")->capture_default_str();
  command->add_option("--phase", arguments->phase, "Place on the orbit, 0 to 1")->check(CLI::Range(0.0, 1.0));
  command->add_flag("--stereo", arguments->stereo, "Two views in one EXR file");
  command->add_flag("--reference", arguments->reference, "Draw with the CPU reference instead");
  command->add_option("--set", arguments->assignments, "Any other setting: key.path=value")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command->add_option("--data", arguments->data, "Folder with volumes");
  command->add_option("--device", arguments->device, "Index or part of the name (volmark device)");
  command->add_flag("--validate", arguments->validate, "Vulkan validation layers");
  command->add_option("--max-volume-gib", arguments->maximumGib, "Largest volume to load")->capture_default_str();
  command->add_option("--mesh", arguments->mesh,
                      "Also write the surface as .ply or .glb (glTF): marching_cubes, optimized_mesh");
  command->add_option("-o,--output", arguments->output, "EXR file to write")->required();
  command->callback([arguments, &exitCode] { exitCode = render(*arguments); });
}

} // namespace volmark
