import { element, say } from '../dom';
import type { SessionClient } from '../engine/session';
import type { Notices } from './notices';

/** What the page says about its session: in the bar as a word, over the picture while there is none. */
export class ConnectionState {
  readonly chip = element('span', { className: 'chip', attributes: { role: 'status' } }, 'connecting');
  readonly banner = element('div', { className: 'banner', hidden: true, attributes: { role: 'alert' } });

  constructor(session: SessionClient, peer: string, notices: Notices) {
    const text = element('p');
    const detail = element('p', { className: 'note' });
    this.banner.append(
      element('span', { className: 'spinner', ariaHidden: 'true' }),
      element('div', {}, text, detail),
    );
    const show = () => {
      const { connection, welcome, role } = session;
      this.banner.hidden = connection.state !== 'lost';
      this.banner.classList.toggle('final', connection.state === 'lost' && !connection.again);
      if (connection.state === 'lost') {
        say(text, connection.again ? `Lost the way to ${peer}.` : `${capital(peer)} is not to be had.`);
        say(
          detail,
          connection.again
            ? 'Trying again by itself; what you see stands still meanwhile.'
            : connection.reason,
        );
      }
      const engine = welcome?.engine === 'wasm' ? 'in this page' : 'native';
      const watching =
        role.role === 'watcher' ? ' · watching' : role.clients > 1 ? ` · ${role.clients - 1} watching` : '';
      say(
        this.chip,
        connection.state === 'connected'
          ? engine + watching
          : connection.state === 'lost'
            ? 'not connected'
            : 'connecting',
      );
      this.chip.classList.toggle('bad', connection.state === 'lost');
      this.chip.title = welcome ? `${welcome.program}, threads: ${welcome.threads}` : '';
    };
    session.on('connection', show);
    session.on('role', show);
    session.on('restarted', () => notices.show('info', 'The program was restarted; the scene begins anew.'));
    session.on('role', ({ role }) => {
      if (role === 'watcher')
        notices.show(
          'info',
          'Another page works on this scene; you watch.',
          'When it is closed, the scene is yours.',
        );
    });
  }
}

function capital(text: string): string {
  return text.charAt(0).toUpperCase() + text.slice(1);
}
