// The transfers of the libusb replacement, which deliver the camera's packets in real time.

#include <libusb.h>
#include <sched.h>
#include <sys/time.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <deque>
#include <ratio>
#include <span>
#include <thread>
#include <utility>

#include "kinect/emulated/libusb_context.hpp"

using std::chrono::steady_clock;

namespace {

constexpr auto microframe = std::chrono::microseconds(125);

steady_clock::time_point due(const libusb_context& context) {
  const double real =
      static_cast<double>(context.microframes + context.waiting.front()->num_iso_packets) /
      context.bus->kinect.speed;
  return context.begin + std::chrono::duration_cast<steady_clock::duration>(
                             real * std::chrono::duration<double>(microframe));
}

/// Completes the oldest transfer. @param waiting  not empty
void complete(libusb_context& context, std::deque<libusb_transfer*>& waiting) {
  libusb_transfer* transfer = waiting.front();
  waiting.pop_front();
  context.microframes += transfer->num_iso_packets;
  transfer->status = LIBUSB_TRANSFER_COMPLETED;
  std::uint8_t* buffer = transfer->buffer;
  for (int i = 0; i < transfer->num_iso_packets; ++i) {
    libusb_iso_packet_descriptor& packet = transfer->iso_packet_desc[i];
    packet.status = LIBUSB_TRANSFER_COMPLETED;
    packet.actual_length = static_cast<unsigned>(context.bus->camera.next_packet(
        std::span(buffer, packet.length), transfer->endpoint & 0x0F));
    buffer += packet.length;
  }
  transfer->callback(transfer);
}

/// Completes all transfers of a program that came too late for the last of them. What the camera
/// sent meanwhile is lost. Real time begins anew when they are submitted again.
/// @return whether it came too late
bool complete_late(libusb_context& context) {
  using Microframes = std::chrono::duration<double, std::ratio<1, 8000>>;
  const int endpoint = context.waiting.front()->endpoint & 0x0F;
  std::int64_t end = context.microframes;
  for (const libusb_transfer* transfer : context.waiting) {
    end += transfer->num_iso_packets;
  }
  const Microframes passed = steady_clock::now() - context.begin;
  const auto missed = static_cast<std::int64_t>(passed.count() * context.bus->kinect.speed) - end;
  if (missed <= 0) {
    return false;
  }
  std::deque<libusb_transfer*> late = std::exchange(context.waiting, {});
  while (!late.empty()) {
    complete(context, late);
  }
  std::array<std::uint8_t, octurn::max_iso_packet_bytes> nowhere = {};
  for (std::int64_t i = 0; i < missed; ++i) {
    context.bus->camera.next_packet(nowhere, endpoint);
  }
  context.begin = steady_clock::now();
  context.microframes = 0;
  return true;
}

/// Ends all transfers with a status. @return whether there were any
bool give_back(std::deque<libusb_transfer*>& transfers, libusb_transfer_status status) {
  const bool any = !transfers.empty();
  while (!transfers.empty()) {
    libusb_transfer* transfer = transfers.front();
    transfers.pop_front();
    transfer->status = status;
    transfer->callback(transfer);
  }
  return any;
}

/// Ends the transfers that are due. Unlike a real device, the emulation drops data for a program
/// that a busy machine delays only if it `is_hasty`: losses are up to the tests.
/// @return whether any transfer ended
bool handle_events(libusb_context& context) {
  const bool keeps = context.bus && context.bus->kinect.keeps_transfers;
  if (!keeps && give_back(context.cancelled, LIBUSB_TRANSFER_CANCELLED)) {
    return true;
  }
  if (context.waiting.empty()) {
    return false;
  }
  if (is_dead(*context.waiting.front()->dev_handle)) {
    return give_back(context.waiting, LIBUSB_TRANSFER_NO_DEVICE);
  }
  if (due(context) > steady_clock::now()) {
    return false;
  }
  if (!context.bus->kinect.is_hasty || !complete_late(context)) {
    complete(context, context.waiting);
  }
  return true;
}

}  // namespace

extern "C" {

libusb_transfer* libusb_alloc_transfer(int packets) {
  return static_cast<libusb_transfer*>(
      std::calloc(1, sizeof(libusb_transfer) +
                         static_cast<std::size_t>(packets) * sizeof(libusb_iso_packet_descriptor)));
}

void libusb_free_transfer(libusb_transfer* transfer) { std::free(transfer); }

int libusb_submit_transfer(libusb_transfer* transfer) {
  if (is_dead(*transfer->dev_handle)) {
    return LIBUSB_ERROR_NO_DEVICE;
  }
  libusb_context& context = *transfer->dev_handle->device->context;
  if (context.waiting.empty()) {
    context.begin = steady_clock::now();
    context.microframes = 0;
  }
  context.waiting.push_back(transfer);
  return 0;
}

int libusb_cancel_transfer(libusb_transfer* transfer) {
  libusb_context& context = *transfer->dev_handle->device->context;
  const auto found = std::ranges::find(context.waiting, transfer);
  if (found == context.waiting.end()) {
    return LIBUSB_ERROR_NOT_FOUND;
  }
  context.waiting.erase(found);
  context.cancelled.push_back(transfer);
  return 0;
}

int libusb_handle_events_timeout(libusb_context* context, timeval* timeout) {
  if (context->bus && context->bus->kinect.interruptions > 0) {
    --context->bus->kinect.interruptions;
    return LIBUSB_ERROR_INTERRUPTED;
  }
  sched_param parameters = {};
  if (context->bus && ::sched_getparam(0, &parameters) == 0) {
    context->bus->kinect.stream_priority = parameters.sched_priority;
  }
  constexpr auto tick = std::chrono::milliseconds(5);
  const auto deadline = steady_clock::now() + std::chrono::seconds(timeout->tv_sec) +
                        std::chrono::microseconds(timeout->tv_usec);
  while (!handle_events(*context) && steady_clock::now() < deadline) {
    const auto next = context->waiting.empty() ? steady_clock::now() + tick : due(*context);
    std::this_thread::sleep_until(std::min(next, deadline));
  }
  return 0;
}

int libusb_handle_events(libusb_context* context) {
  timeval minute{.tv_sec = 60, .tv_usec = 0};
  return libusb_handle_events_timeout(context, &minute);
}

}  // extern "C"
