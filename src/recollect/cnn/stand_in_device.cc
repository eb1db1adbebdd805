#include "recollect/cnn/stand_in_device.h"

#include <ATen/EmptyTensor.h>
#include <ATen/NativeFunctions.h>
#include <ATen/native/CPUFallback.h>
#include <c10/core/impl/DeviceGuardImplInterface.h>
#include <torch/library.h>

#include <cstdint>

// By the hooks that c10 has for devices of other people's making. XPU is one whose tensors libtorch
// takes for those of a module, and which Debian's libtorch does not serve.
namespace recollect::cnn {
namespace {

constexpr c10::DeviceType kType = c10::DeviceType::XPU;
constexpr auto kKey = c10::DispatchKey::XPU;
constexpr std::uintptr_t kAway = std::uintptr_t{1} << 62;  // no address of a program's has this bit

C10_REGISTER_GUARD_IMPL(XPU, c10::impl::NoOpDeviceGuardImpl<kType>);

class Allocator : public c10::Allocator {
 public:
  c10::DataPtr allocate(std::size_t bytes) const override {
    if (bytes == 0) return {nullptr, c10::Device(kType, 0)};
    void* real = std::malloc(bytes);
    return {reinterpret_cast<void*>(reinterpret_cast<std::uintptr_t>(real) | kAway), real,
            &std::free, c10::Device(kType, 0)};
  }
};

Allocator* TheAllocator() {
  static Allocator allocator;
  return &allocator;
}

// The same values as a tensor of the processor's.
at::Tensor Reached(const at::Tensor& tensor) {
  if (!tensor.defined() || tensor.device().type() != kType) return tensor;
  auto* real =
      reinterpret_cast<void*>(reinterpret_cast<std::uintptr_t>(tensor.data_ptr()) & ~kAway);
  return at::from_blob(real, tensor.sizes(), tensor.strides(),
                       at::TensorOptions(tensor.scalar_type()));
}

at::Tensor Empty(at::IntArrayRef size, c10::optional<at::ScalarType> type,
                 c10::optional<at::Layout>, c10::optional<at::Device>, c10::optional<bool>,
                 c10::optional<at::MemoryFormat> format) {
  return at::detail::empty_generic(size, TheAllocator(), c10::DispatchKeySet(kKey),
                                   type.value_or(at::kFloat), format);
}

at::Tensor EmptyStrided(at::IntArrayRef size, at::IntArrayRef stride,
                        c10::optional<at::ScalarType> type, c10::optional<at::Layout>,
                        c10::optional<at::Device>, c10::optional<bool>) {
  return at::detail::empty_strided_generic(size, stride, TheAllocator(), c10::DispatchKeySet(kKey),
                                           type.value_or(at::kFloat));
}

at::Tensor CopyFrom(const at::Tensor& from, const at::Tensor& to, bool) {
  Reached(to).copy_(Reached(from));
  return to;
}

const at::Tensor& Resize(const at::Tensor& tensor, at::IntArrayRef size,
                         c10::optional<at::MemoryFormat>) {
  if (tensor.sizes() == size) return tensor;
  const at::Tensor fresh = at::empty(size, tensor.options());
  tensor.unsafeGetTensorImpl()->set_storage_keep_dtype(fresh.storage());
  tensor.unsafeGetTensorImpl()->set_sizes_contiguous(size);
  return tensor;
}

at::Tensor CopyFromAndResize(const at::Tensor& from, const at::Tensor& to) {
  to.resize_(from.sizes());
  return CopyFrom(from, to, false);
}

at::Tensor There(const at::Tensor& tensor) { return tensor.to(StandInDevice()); }

at::Tensor Convolution(const at::Tensor& input, const at::Tensor& weight,
                       const c10::optional<at::Tensor>& bias, at::IntArrayRef stride,
                       at::IntArrayRef padding, at::IntArrayRef dilation, bool transposed,
                       at::IntArrayRef output_padding, std::int64_t groups) {
  return There(at::convolution(Reached(input), Reached(weight),
                               bias ? Reached(*bias) : at::Tensor(), stride, padding, dilation,
                               transposed, output_padding, groups));
}

std::tuple<at::Tensor, at::Tensor, at::Tensor> ConvolutionBackward(
    const at::Tensor& gradient, const at::Tensor& input, const at::Tensor& weight,
    at::IntArrayRef stride, at::IntArrayRef padding, at::IntArrayRef dilation, bool transposed,
    at::IntArrayRef output_padding, std::int64_t groups, std::array<bool, 3> wanted) {
  const std::vector<std::int64_t> bias = {weight.size(0)};
  const auto [of_input, of_weight, of_bias] = at::convolution_backward(
      Reached(gradient), Reached(input), Reached(weight), at::IntArrayRef(bias), stride, padding,
      dilation, transposed, output_padding, groups, wanted);
  const auto there = [](const at::Tensor& t) { return t.defined() ? There(t) : t; };
  return {there(of_input), there(of_weight), there(of_bias)};
}

void RequireHere(const at::Tensor& tensor, const c10::OperatorHandle& operation) {
  TORCH_CHECK(!tensor.defined() || tensor.device().type() == kType || tensor.dim() == 0,
              operation.operator_name(), " got a tensor on ", tensor.device(),
              " beside those of the device");
}

void Fallback(const c10::OperatorHandle& operation, torch::jit::Stack* stack) {
  const std::size_t arguments = operation.schema().arguments().size();
  for (std::size_t i = stack->size() - arguments; i < stack->size(); ++i) {
    const c10::IValue& value = (*stack)[i];
    if (value.isTensor()) RequireHere(value.toTensor(), operation);
    if (!value.isTensorList()) continue;
    for (const at::Tensor& tensor : value.toTensorVector()) RequireHere(tensor, operation);
  }
  at::native::cpu_fallback(operation, stack);
}

TORCH_LIBRARY_IMPL(_, XPU, library) {
  library.fallback(torch::CppFunction::makeFromBoxedFunction<&Fallback>());
}

TORCH_LIBRARY_IMPL(aten, XPU, library) {
  library.impl("empty.memory_format", &Empty);
  library.impl("empty_strided", &EmptyStrided);
  library.impl("_copy_from", &CopyFrom);
  library.impl("resize_", &Resize);
  library.impl("_copy_from_and_resize", &CopyFromAndResize);
  library.impl("as_strided", &at::native::as_strided_tensorimpl);
  library.impl("view", &at::native::view);
  library.impl("_reshape_alias", &at::native::_reshape_alias);
  library.impl("unfold", &at::native::unfold);
  library.impl("convolution_overrideable", &Convolution);
  library.impl("convolution_backward_overrideable", &ConvolutionBackward);
}

}  // namespace

torch::Device StandInDevice() { return {kType, 0}; }

}  // namespace recollect::cnn
