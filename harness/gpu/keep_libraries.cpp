// In sanitized builds only: libraries stay loaded until the process ends. The Vulkan loader unloads its driver with the
// last instance; the leak checker, which runs at the end, could then neither name nor suppress what the driver left.
extern "C" __attribute__((visibility("default"))) int dlclose(void* /*library*/) {
  return 0;
}
