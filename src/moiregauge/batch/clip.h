// SPDX-License-Identifier: Apache-2.0
// A clip of a batch, and the files of the batch's folder OUT.
#pragma once

#include <filesystem>
#include <string>

namespace moiregauge::internal {

struct Clip {
  std::string name;   // name of its run directory in OUT
  std::string input;  // absolute path of a video file, TIFF stack or folder of images
  std::string site;   // absolute path of the site.toml next to it. Empty: none
};

// Files of OUT. No run directory has one of these names, because its name has no dot (run_name.h).
struct BatchFolder {
  std::filesystem::path path;

  [[nodiscard]] std::filesystem::path run(const std::string& name) const { return path / name; }
  [[nodiscard]] std::filesystem::path table() const { return path / "batch.csv"; }
  [[nodiscard]] std::filesystem::path catalogue() const { return path / "catalogue.sqlite"; }
  [[nodiscard]] std::filesystem::path page() const { return path / "index.html"; }
  // Facts about the clips, for the batch only.
  [[nodiscard]] std::filesystem::path own() const { return path / ".batch"; }
  [[nodiscard]] std::filesystem::path clips() const { return own() / "clips.jsonl"; }
  [[nodiscard]] std::filesystem::path lock() const { return own() / "lock"; }
  [[nodiscard]] std::filesystem::path states() const { return own() / "state"; }
  [[nodiscard]] std::filesystem::path state(const std::string& name) const { return states() / (name + ".json"); }
  [[nodiscard]] std::filesystem::path slurm() const { return own() / "slurm"; }
};

}  // namespace moiregauge::internal
