import './style/tokens.css';
import './style/bar.css';
import './style/theatre.css';
import './style/tools.css';
import './style/measures.css';
import './style/words.css';
import './style/panel.css';
import { Charts } from './chart/charts';
import { fillBar } from './chrome/bar';
import { ConnectionState } from './chrome/connection';
import { Files, saveBlob } from './chrome/files';
import { helpDialog } from './chrome/help';
import { Hint } from './chrome/hint';
import { legendOf } from './chrome/legend';
import { Notices } from './chrome/notices';
import { statusLine } from './chrome/status';
import { Theme } from './chrome/theme';
import { ToolStrip } from './chrome/tool-strip';
import { byId } from './dom';
import { View } from './drawing/view';
import { chooseTransport } from './engine/choose';
import { SessionClient } from './engine/session';
import { handleKeys } from './handling/keyboard';
import { PointerHandling } from './handling/pointer';
import { Tools } from './handling/tools';
import { exposeState } from './hook';
import { ParameterPanel } from './panel/parameters';
import { ShownPanel } from './panel/shown';

async function main(): Promise<void> {
  const transport = await chooseTransport(location);
  const session = new SessionClient(transport);
  const notices = new Notices();
  const theme = new Theme();
  const files = new Files(session, notices);
  const connection = new ConnectionState(session, transport.peer, notices);
  const help = helpDialog();
  const hint = new Hint();

  const view = new View(byId('view', HTMLCanvasElement));
  const tools: Tools = new Tools(session, () => {
    view.stage.setChosen(tools.chosen?.instrument);
    view.invalidate();
    strip.show();
    const others = tools.list.filter((tool) => tool !== tools.chosen);
    if (session.scene)
      hint.show(
        tools.chosen?.manner,
        others.map(({ manner, name }) => [manner, name] as const),
      );
  });
  const pointer = new PointerHandling(view, tools, () => hint.dismiss());
  const strip = new ToolStrip(session, tools, (part) => pointer.deepen(part));
  const actions = {
    pauseOrPlay: () => session.send({ type: session.frame?.state === 'running' ? 'pause' : 'play' }),
    step: () => session.send({ type: 'step' }),
    reset: () => {
      tools.drop();
      session.send({ type: 'reset' });
    },
    picture: () => void view.picture().then((blob) => saveBlob('viscera.png', blob)),
    help: () => (help.open ? help.close() : help.showModal()),
    togglePanel: () => document.body.classList.toggle('without-panel'),
  };
  handleKeys(view, tools, () => session.scene?.radius ?? 1, actions);

  fillBar(byId('bar', HTMLElement), session, actions, files, theme, connection.chip);
  byId('theatre', HTMLElement).append(
    statusLine(session, view),
    strip.node,
    hint.node,
    legendOf(session),
    new Charts(session, () => tools.chosen?.instrument).node,
    notices.node,
    connection.banner,
    files.overlay,
    help,
  );
  const parameters = new ParameterPanel(session);
  byId('panel', HTMLElement).append(new ShownPanel(session).node, parameters.node);

  theme.follow((dark) => view.setTheme(dark));
  session.on('scene', (scene) => view.setScene(scene));
  session.on('surface', (surface) => view.setSurface(surface));
  session.on('frame', (frame) => view.setFrame(frame));
  session.on('notice', ({ level, text, help: advice }) => notices.show(level, text, advice));
  session.on('refusal', (refusal) => {
    if (refusal.command === 'move-instrument') return;
    if (!parameters.showsKey(refusal.key))
      notices.show('error', refusal.reason, refusal.help, refusal.excerpt);
  });
  exposeState(session, view, tools);
  session.open();
}

main().catch((error: unknown) => {
  const text = document.createElement('p');
  text.className = 'fatal';
  text.textContent = `The page could not begin: ${error instanceof Error ? error.message : String(error)}`;
  document.body.replaceChildren(text);
});
