#include "technique/catalogue.h"

#include "technique/module_file.h"
#include "volmark/error.h"
#include "volmark/parameters.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>

namespace volmark {

namespace {

bool isModule(const std::filesystem::directory_entry& entry) {
  std::error_code code;
  return entry.path().extension() == ".so" && entry.is_regular_file(code);
}

std::vector<std::filesystem::path> modulesIn(const std::filesystem::path& folder, std::vector<std::string>& problems) {
  std::vector<std::filesystem::path> files;
  std::error_code code;
  std::filesystem::directory_iterator entry(folder, code);
  if (code) {
    problems.push_back(fmt::format("{}: can't be searched for technique modules: {}", folder.string(), code.message()));
    return files;
  }
  for (; entry != std::filesystem::directory_iterator(); entry.increment(code)) {
    if (code) break;
    if (isModule(*entry)) files.push_back(entry->path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

bool byName(const CatalogueEntry& a, const CatalogueEntry& b) {
  return a.factory->info.name < b.factory->info.name;
}

/// Why a factory can't be offered, or nothing.
std::optional<std::string> whyUnusable(const TechniqueFactory& factory) {
  if (factory.info.name.empty()) return "a technique has no name";
  if (!factory.create) return fmt::format("technique \"{}\" has no create function", factory.info.name);
  return std::nullopt;
}

} // namespace

TechniqueCatalogue::TechniqueCatalogue(const std::vector<std::filesystem::path>& folders) {
  for (const std::filesystem::path& folder : folders) {
    for (const std::filesystem::path& file : modulesIn(folder, m_problems)) {
      const auto [module, problem] = openModule(file);
      if (!module) {
        m_problems.push_back(problem);
        continue;
      }
      for (const TechniqueFactory& factory : module->description->techniques) {
        if (const auto why = whyUnusable(factory))
          m_problems.push_back(fmt::format("{}: {}", file.string(), *why));
        else if (const CatalogueEntry* first = find(factory.info.name))
          m_problems.push_back(fmt::format("{}: technique \"{}\" is already offered by {}", file.string(),
                                           factory.info.name, first->module.string()));
        else
          m_entries.push_back({&factory, module->description->family, file, module->digest});
      }
    }
  }
  std::sort(m_entries.begin(), m_entries.end(), byName);
}

const CatalogueEntry* TechniqueCatalogue::find(const std::string& name) const {
  const auto found = std::find_if(m_entries.begin(), m_entries.end(),
                                  [&](const CatalogueEntry& entry) { return entry.factory->info.name == name; });
  return found == m_entries.end() ? nullptr : &*found;
}

const CatalogueEntry& TechniqueCatalogue::get(const std::string& name) const {
  if (const CatalogueEntry* entry = find(name)) return *entry;
  if (m_entries.empty())
    throw InputError(fmt::format("unknown technique \"{}\": no technique was loaded ({})", name,
                                 m_problems.empty() ? "no modules found; VOLMARK_TECHNIQUES names folders to search"
                                                    : fmt::format("{}", fmt::join(m_problems, "; "))));
  std::vector<std::string> names;
  for (const CatalogueEntry& entry : m_entries)
    names.push_back(entry.factory->info.name);
  const auto nearest = nearestName(name, names);
  throw InputError(fmt::format("unknown technique \"{}\"{} allowed: {}", name,
                               nearest ? fmt::format(", did you mean \"{}\"?", *nearest) : ",",
                               fmt::join(names, ", ")));
}

void TechniqueCatalogue::add(const TechniqueFactory& factory, std::string family) {
  m_entries.push_back({&factory, std::move(family), {}, ""});
  std::sort(m_entries.begin(), m_entries.end(), byName);
}

std::vector<std::filesystem::path> techniqueFolders() {
  std::vector<std::filesystem::path> folders;
  if (const char* variable = std::getenv("VOLMARK_TECHNIQUES")) {
    std::istringstream parts(variable);
    for (std::string part; std::getline(parts, part, ':');)
      if (!part.empty()) folders.emplace_back(part);
  }
  std::error_code code;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", code);
  if (code) return folders;
  const std::filesystem::path beside = program.parent_path();
  // Neither of these has to be there; what the user names does.
  for (const auto& folder : {beside / "techniques", beside.parent_path() / "lib" / "volmark" / "techniques"})
    if (std::filesystem::is_directory(folder, code)) folders.push_back(folder);
  return folders;
}

} // namespace volmark
