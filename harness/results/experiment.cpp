#include "results/experiment.h"

#include "results/csv.h"
#include "results/files.h"
#include "results/index.h"
#include "results/provenance.h"
#include "results/run_document.h"
#include "volmark/error.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <sys/stat.h>
#include <unistd.h>

namespace fs = std::filesystem;

namespace volmark {

namespace {

constexpr int kIndent = 1;

std::string textOf(const nlohmann::ordered_json& document) {
  return document.dump(kIndent, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

/// Creates a folder and those above it; takes back what it created unless kept.
class NewFolders {
public:
  explicit NewFolders(const fs::path& folder) {
    std::vector<fs::path> missing;
    std::error_code unseen; // what is wrong shows when the folders are made
    for (fs::path path = folder; !path.empty() && !fs::exists(path, unseen); path = path.parent_path())
      missing.push_back(path);
    for (auto path = missing.rbegin(); path != missing.rend(); ++path) {
      if (mkdir(path->c_str(), 0777) == 0)
        m_created.push_back(*path);
      else if (errno != EEXIST)
        m_error = errno;
    }
    if (m_error == 0 && !fs::is_directory(folder, unseen)) m_error = ENOTDIR;
    if (m_error == 0 && access(folder.c_str(), W_OK | X_OK) != 0) m_error = errno;
  }
  ~NewFolders() {
    for (auto path = m_created.rbegin(); path != m_created.rend(); ++path)
      rmdir(path->c_str());
  }
  NewFolders(const NewFolders&) = delete;
  NewFolders& operator=(const NewFolders&) = delete;
  void keep() { m_created.clear(); }
  int error() const { return m_error; }

private:
  std::vector<fs::path> m_created;
  int m_error = 0;
};

nlohmann::ordered_json experimentDocument(const Scenario& scenario, const std::string& created) {
  const ProgramVersion program = programVersion();
  auto points = nlohmann::ordered_json::array();
  for (const Point& point : scenario.points)
    points.push_back({{"index", point.index},
                      {"labels", labelsDocument(point.labels)},
                      {"block", point.block},
                      {"group", point.group},
                      {"replicates", point.settings.measure.replicates}});
  return {{"format", "volmark.experiment"},
          {"version", kFormatVersion},
          {"name", scenario.name},
          {"title", scenario.title},
          {"description", scenario.description},
          {"config_file", scenario.file.filename().string()},
          {"profile", scenario.profile},
          {"assignments", scenario.assignments},
          {"created", created},
          {"program", {{"version", program.version}, {"commit", program.commit}}},
          {"scenario", nlohmann::ordered_json(scenario.document)},
          {"axes", scenario.axes},
          {"points", points}};
}

// What stands there must be an earlier state of the same experiment. Returns when it was created, or "".
std::string checkExisting(const fs::path& file, const std::string& name) {
  std::error_code error;
  if (!fs::exists(file, error)) return "";
  const auto refuse = [&file](const std::string& place, const std::string& found, const std::string& allowed) {
    throw InputError(fmt::format("{}: {}found {}, allowed: {}; choose another results folder or move this one away",
                                 file.string(), place, found, allowed));
  };
  const auto document = readJson(file);
  if (!document || !document->is_object()) refuse("", "something that isn't an experiment", "an experiment.json");
  const auto member = [&document](const char* key) {
    return document->contains(key) ? document->at(key) : nlohmann::json(nullptr);
  };
  if (member("format") != "volmark.experiment") refuse("/format: ", member("format").dump(), "\"volmark.experiment\"");
  if (member("version") != kFormatVersion)
    refuse("/version: ", member("version").dump(), std::to_string(kFormatVersion));
  if (member("name") != name) refuse("/name: ", member("name").dump(), nlohmann::json(name).dump());
  return textAt(*document, "/created");
}

// Folders that runs are staged in: ".<run>.<pid>", and ".<run>.<pid>.replaced" for an attempt on its way out.
std::vector<fs::path> hiddenFolders(const fs::path& shelf, const std::string& run) {
  std::vector<fs::path> found;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(shelf, error))
    if (entry.path().filename().string().starts_with("." + run + ".")) found.push_back(entry.path());
  return found;
}

fs::path ownStage(const fs::path& runFolder) {
  return runFolder.parent_path() / fmt::format(".{}.{}", runFolder.filename().string(), getpid());
}

void createFolders(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw DeviceError(fmt::format("{}: can't be created: {}", folder.string(), error.message()));
}

// The staging folder of this process, else the newest that a worker left, else a new one.
fs::path stageToCommit(const fs::path& runFolder) {
  const fs::path own = ownStage(runFolder);
  if (fs::exists(own)) return own;
  createFolders(runFolder.parent_path());
  std::optional<fs::path> newest;
  for (const fs::path& left : hiddenFolders(runFolder.parent_path(), runFolder.filename().string()))
    if (left.extension() != ".replaced" && (!newest || fs::last_write_time(left) > fs::last_write_time(*newest)))
      newest = left;
  if (newest) return *newest;
  createFolders(own);
  return own;
}

void removePictures(const fs::path& stage) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(stage, error))
    if (entry.path().extension() == ".exr") fs::remove(entry.path(), error);
}

void requirePictures(const fs::path& stage, const std::vector<PictureRow>& pictures) {
  for (const PictureRow& picture : pictures)
    if (!fs::is_regular_file(stage / picture.file))
      throw std::logic_error(fmt::format("{}: the run's picture isn't there", (stage / picture.file).string()));
}

// Files before the folder that names them, so that after a power cut a name never stands for less than its file.
void syncFolder(const fs::path& folder) {
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.is_regular_file()) syncPath(entry.path());
  syncPath(folder);
}

// One rename makes the whole folder, run.json included, appear under its final name. Whoever dies before leaves
// a hidden folder, which the next attempt removes; an earlier attempt is moved out by a rename of its own, so
// that between the two the run counts as not done.
void install(const fs::path& stage, const fs::path& runFolder) {
  const auto rename = [](const fs::path& from, const fs::path& to) {
    if (::rename(from.c_str(), to.c_str()) != 0)
      throw DeviceError(fmt::format("{}: can't be written: {}", to.string(), std::strerror(errno)));
  };
  const fs::path replaced = stage.string() + ".replaced";
  std::error_code error;
  fs::remove_all(replaced, error);
  if (fs::exists(runFolder)) rename(runFolder, replaced);
  rename(stage, runFolder);
  syncPath(runFolder.parent_path());
  fs::remove_all(replaced, error);
}

} // namespace

Experiment::Experiment(const fs::path& resultsFolder, const Scenario& scenario)
    : m_folder(resultsFolder / scenario.name), m_axes(scenario.axes) {
  const fs::path file = m_folder / "experiment.json";
  std::string created = checkExisting(file, scenario.name);
  if (created.empty()) created = utcNow();
  NewFolders folders(m_folder);
  if (folders.error() != 0)
    throw InputError(fmt::format("{}: can't be written: {}", m_folder.string(), std::strerror(folders.error())));
  try {
    replaceFile(file, textOf(experimentDocument(scenario, created)));
  } catch (const DeviceError& error) {
    throw InputError(error.what());
  }
  folders.keep();
}

Experiment reopenExperiment(const fs::path& folder) {
  const auto document = readJson(folder / "experiment.json").value_or(nlohmann::json::object());
  fs::path path = fs::absolute(folder).lexically_normal();
  if (!path.has_filename()) path = path.parent_path(); // "results/quick/"
  return Experiment(path, document.value("axes", std::vector<std::string>()));
}

fs::path Experiment::runFolder(const RunIdentity& identity) const {
  return m_folder / "runs" / identity.run.substr(0, 2) / identity.run;
}

std::optional<std::string> Experiment::statusOf(const RunIdentity& identity) const {
  const fs::path file = runFolder(identity) / "run.json";
  const auto run = readJson(file);
  if (!run || !run->is_object()) return std::nullopt;
  requireVersion(*run, file);
  const std::string status = textAt(*run, "/status");
  return status.empty() ? std::nullopt : std::optional(status);
}

std::unique_ptr<Claim> Experiment::claim(const RunIdentity& identity) const {
  const fs::path folder = runFolder(identity);
  createFolders(folder.parent_path());
  return Claim::take(folder.string() + ".claim", m_watch);
}

void Experiment::releaseStaleClaim(const RunIdentity& identity) const {
  if (fs::exists(runFolder(identity).string() + ".claim")) claim(identity); // taken over and given back at once
}

void Experiment::discard(const RunIdentity& identity) const {
  std::error_code error;
  for (const fs::path& left : hiddenFolders(runFolder(identity).parent_path(), identity.run))
    fs::remove_all(left, error);
}

fs::path Experiment::stage(const RunIdentity& identity) const {
  const fs::path folder = runFolder(identity);
  discard(identity);
  createFolders(ownStage(folder));
  return ownStage(folder);
}

void Experiment::commit(const RunIdentity& identity, const Point& point, const CatalogueEntry& technique,
                        const RunRecord& record) const {
  const TechniqueInfo& info = technique.factory->info;
  const fs::path stage = stageToCommit(runFolder(identity));
  const bool isCompleted = record.status == RunStatus::completed;
  try {
    if (isCompleted)
      requirePictures(stage, record.pictures);
    else
      removePictures(stage);
    writeFile(stage / "frames.csv", framesCsv(record.frames, info));
    writeFile(stage / "counters.csv", countersCsv(record.counters, info));
    writeFile(stage / "pictures.csv",
              picturesCsv(isCompleted ? std::span(record.pictures) : std::span<const PictureRow>(), info));
    writeFile(stage / "run.json", textOf(runDocument(identity, point, technique, record)));
    syncFolder(stage);
    install(stage, runFolder(identity));
  } catch (...) {
    std::error_code error;
    fs::remove_all(stage, error);
    throw;
  }
}

void Experiment::writeIndex() const {
  const auto runs = readRuns(m_folder);
  replaceFile(m_folder / "index.csv", indexCsv(runs, m_axes));
  replaceFile(m_folder / "google_benchmark.json", textOf(googleBenchmark(m_folder.filename().string(), runs, m_axes)));
}

} // namespace volmark
