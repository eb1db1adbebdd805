#include "recollect/cnn/tensor_file.h"

#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>

#include "recollect/core/error.h"
#include "recollect/core/files.h"

namespace recollect::cnn {
namespace {

static_assert(std::endian::native == std::endian::little, "values are written as they lie");

constexpr std::string_view kMagic = "RECOLCNN";
constexpr int kVersion = 1;
constexpr std::size_t kNumber = sizeof(std::uint64_t);

// FNV-1a over 64-bit words, the rest by bytes: a few GB/s, and any altered bit shows.
std::uint64_t Checksum(std::string_view bytes) {
  constexpr std::uint64_t kPrime = 0x100000001b3ULL;
  std::uint64_t sum = 0xcbf29ce484222325ULL;
  for (; bytes.size() >= kNumber; bytes.remove_prefix(kNumber)) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes.data(), kNumber);
    sum = std::rotl((sum ^ word) * kPrime, 29);
  }
  for (const char byte : bytes) sum = (sum ^ static_cast<std::uint8_t>(byte)) * kPrime;
  return sum;
}

void Append(std::string& out, std::uint64_t number) {
  out.append(reinterpret_cast<const char*>(&number), kNumber);
}

std::uint64_t NumberAt(std::string_view bytes, std::size_t at) {
  std::uint64_t number = 0;
  std::memcpy(&number, bytes.data() + at, kNumber);
  return number;
}

// Takes the tensors that `header` lists off the front of `values`.
std::vector<NamedTensor> TakeTensors(const nlohmann::json& header, std::string_view values,
                                     const std::string& where) {
  std::vector<NamedTensor> tensors;
  for (const auto& entry : header.at("tensors")) {
    const auto shape = entry.at("shape").get<std::vector<std::int64_t>>();
    std::size_t bytes = sizeof(float);
    for (const std::int64_t side : shape) {
      const auto length = static_cast<std::size_t>(side);
      Require(side >= 0 && (length == 0 || bytes <= values.size() / length), where,
              "is cut short or damaged", "copy it again");
      bytes *= length;
    }
    torch::Tensor tensor = torch::empty(shape);
    Require(bytes <= values.size(), where, "is cut short or damaged", "copy it again");
    std::memcpy(tensor.data_ptr<float>(), values.data(), bytes);
    values.remove_prefix(bytes);
    tensors.emplace_back(entry.at("name").get<std::string>(), tensor);
  }
  Require(values.empty(), where, "is longer than its header says", "copy it again");
  return tensors;
}

}  // namespace

const torch::Tensor& TensorFile::Find(const std::string& name, const torch::Tensor& like,
                                      const std::string& where) const {
  for (const auto& [candidate, tensor] : tensors) {
    if (candidate != name) continue;
    Require(tensor.sizes() == like.sizes(), where,
            fmt::format("'{}' has another shape than this network's", name));
    return tensor;
  }
  throw Error(where, fmt::format("has no '{}': it is of another network", name));
}

void WriteTensorFile(const std::filesystem::path& path, const TensorFile& content) {
  nlohmann::json header = content.header;
  header["version"] = kVersion;
  header["tensors"] = nlohmann::json::array();
  for (const auto& [name, tensor] : content.tensors) {
    header["tensors"].push_back({{"name", name}, {"shape", tensor.sizes().vec()}});
  }
  const std::string text = header.dump();
  std::string bytes(kMagic);
  Append(bytes, text.size());
  bytes += text;
  for (const auto& [name, tensor] : content.tensors) {
    const torch::Tensor values = tensor.detach().to(torch::kCPU, torch::kFloat).contiguous();
    bytes.append(reinterpret_cast<const char*>(values.data_ptr<float>()), values.nbytes());
  }
  Append(bytes, Checksum(bytes));
  AtomicWrite(path, bytes);
}

TensorFile ReadTensorFile(const std::filesystem::path& path) {
  const std::string where = path.string();
  const std::string bytes = ReadFile(path);
  const std::string_view view = bytes;
  Require(view.starts_with(kMagic), where, "is not a model file of this program",
          "make one with 'recollect train'");
  constexpr std::size_t kStart = kMagic.size() + kNumber;
  Require(view.size() >= kStart + kNumber, where, "is cut short or damaged", "copy it again");
  const std::string_view checked = view.substr(0, view.size() - kNumber);
  const std::uint64_t length = NumberAt(view, kMagic.size());
  Require(length <= checked.size() - kStart && Checksum(checked) == NumberAt(view, checked.size()),
          where, "is cut short or damaged", "copy it again");
  TensorFile content;
  try {
    content.header = nlohmann::json::parse(view.substr(kStart, length));
    const int version = content.header.at("version").get<int>();
    Require(version <= kVersion, where,
            fmt::format("has version {}, this program knows up to {}", version, kVersion),
            "use a newer program");
    content.tensors = TakeTensors(content.header, checked.substr(kStart + length), where);
  } catch (const nlohmann::json::exception& error) {
    throw Error(where, fmt::format("has a broken header ({})", error.what()));
  }
  return content;
}

}  // namespace recollect::cnn
