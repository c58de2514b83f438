// A browser starts no worker from file://, so the search would not work in pages read from disk.
// There the worker's script runs in a hidden frame, with the same messages.
if (location.protocol === "file:") {
  class IFrameWorker extends EventTarget {
    constructor(url) {
      super()
      const frame = document.createElement("iframe")
      frame.hidden = true
      document.body.append(frame)
      this.window = frame.contentWindow
      this.window.postMessage = data => this.dispatchEvent(new MessageEvent("message", { data }))
      this.ready = new Promise(loaded => {
        const script = this.window.document.createElement("script")
        script.src = url
        script.onload = loaded
        this.window.document.head.append(script)
      })
    }

    postMessage(data) {
      this.ready.then(() => this.window.dispatchEvent(new MessageEvent("message", { data })))
    }
  }
  // The theme asks for this name to find the languages beside the script.
  window.IFrameWorker = window.Worker = IFrameWorker
}
