# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""A headless Chromium that is driven by its DevTools protocol: pages get real mouse events."""

import asyncio
import base64
import os
import shutil
import tempfile

import aiohttp


def find():
    """The program, or None."""
    return shutil.which("chromium") or shutil.which("chromium-browser")


class Page:
    def __init__(self, socket):
        self.socket, self.count, self.answers = socket, 0, {}
        self.listener = asyncio.create_task(self._listen())

    async def _listen(self):
        async for message in self.socket:
            answer = message.json()
            if "id" in answer:
                self.answers.pop(answer["id"]).set_result(answer)

    async def call(self, method, **parameters):
        self.count += 1
        future = self.answers[self.count] = asyncio.get_running_loop().create_future()
        await self.socket.send_json({"id": self.count, "method": method, "params": parameters})
        answer = await asyncio.wait_for(future, 120)
        if "error" in answer:
            raise RuntimeError("%s: %s" % (method, answer["error"]))
        return answer["result"]

    async def evaluate(self, expression):
        result = await self.call("Runtime.evaluate", expression=expression, returnByValue=True,
                                 awaitPromise=True)
        if "exceptionDetails" in result:
            raise RuntimeError(result["exceptionDetails"])
        return result["result"].get("value")

    async def wait_for(self, expression, seconds=120):
        """Until the expression is true; its value."""
        for _ in range(5 * seconds):
            value = await self.evaluate(expression)
            if value:
                return value
            await asyncio.sleep(0.2)
        raise TimeoutError(expression)

    async def mouse(self, kind, x, y, pressed=False):
        await self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y,
                        button="left" if pressed or kind == "mouseReleased" else "none",
                        buttons=1 if pressed else 0, clickCount=0 if kind == "mouseMoved" else 1)

    async def drag(self, start, stop, steps=6):
        await self.mouse("mouseMoved", *start)
        await asyncio.sleep(0.5)
        await self.mouse("mousePressed", *start, pressed=True)
        for step in range(1, steps + 1):
            await self.mouse("mouseMoved", *(a + (b - a) * step / steps for a, b in zip(start, stop)),
                             pressed=True)
            await asyncio.sleep(0.2)
        await self.mouse("mouseReleased", *stop)

    async def click(self, selector):
        """In the middle of an element."""
        x, y = await self.wait_for(
            "(() => { const e = document.querySelector(%r); if (!e) return null; "
            "const r = e.getBoundingClientRect(); "
            "return r.width ? [r.x + r.width / 2, r.y + r.height / 2] : null; })()" % selector)
        await self.mouse("mouseMoved", x, y)
        await self.mouse("mousePressed", x, y, pressed=True)
        await self.mouse("mouseReleased", x, y)

    async def screenshot(self, path=None):
        png = base64.b64decode((await self.call("Page.captureScreenshot"))["data"])
        if path:
            with open(path, "wb") as file:
                file.write(png)
        return png

    async def close(self):
        await self.socket.close()
        self.listener.cancel()


class Browser:
    """async with Browser() as browser: page = await browser.open(address)"""

    async def __aenter__(self):
        self.folder = tempfile.mkdtemp(prefix="ffd-browser-")
        self.process = await asyncio.create_subprocess_exec(
            find(), "--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage",
            "--no-first-run", "--window-size=1100,750", "--remote-debugging-port=0",
            "--user-data-dir=" + self.folder, "about:blank",
            stdout=asyncio.subprocess.DEVNULL, stderr=asyncio.subprocess.DEVNULL)
        ready = os.path.join(self.folder, "DevToolsActivePort")
        for _ in range(600):
            if os.path.exists(ready):
                break
            await asyncio.sleep(0.2)
        with open(ready, encoding="ascii") as file:
            self.port = int(file.readline())
        self.client = aiohttp.ClientSession()
        self.pages = []
        return self

    async def open(self, address):
        async with self.client.put(
                "http://127.0.0.1:%d/json/new?%s" % (self.port, address)) as answer:
            target = await answer.json()
        page = Page(await self.client.ws_connect(target["webSocketDebuggerUrl"], max_msg_size=0))
        self.pages.append(page)
        await page.call("Page.enable")
        return page

    async def __aexit__(self, *_):
        for page in self.pages:
            await page.close()
        await self.client.close()
        self.process.kill()
        await self.process.wait()
        shutil.rmtree(self.folder, ignore_errors=True)
