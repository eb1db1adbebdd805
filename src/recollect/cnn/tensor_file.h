#pragma once

#include <torch/torch.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

namespace recollect::cnn {

using NamedTensor = std::pair<std::string, torch::Tensor>;

// The container of model files and checkpoints: eight bytes "RECOLCNN", the length of a JSON
// header (64 bits), the header, the tensors' values in the header's order (32-bit floats) and a
// checksum over all of it (64 bits). Little endian.
struct TensorFile {
  nlohmann::json header;
  std::vector<NamedTensor> tensors;

  // The tensor of that name. Throws Error naming `where` when there is none, or when its shape is
  // not the one of `like`.
  const torch::Tensor& Find(const std::string& name, const torch::Tensor& like,
                            const std::string& where) const;
};

// Written beside its target and renamed into place. Throws Error as AtomicWrite does.
void WriteTensorFile(const std::filesystem::path& path, const TensorFile& content);

// Throws Error naming the file when it is missing, of another kind, of a newer version, cut short,
// longer than it says, or altered.
TensorFile ReadTensorFile(const std::filesystem::path& path);

}  // namespace recollect::cnn
