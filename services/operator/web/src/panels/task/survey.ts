// SurveyJS, loaded when the first form is shown. Its UI brings its own Preact.
import { Model, type Question, SvgRegistry, settings, surveyLocalization } from "survey-core";
import "survey-core/survey-core.fontless.min.css";
import { render, renderSurvey } from "survey-js-ui";
import "./survey.css";

// The page's policy forbids styles in markup, which one icon has: that of timers.
for (const [name, icon] of Object.entries(SvgRegistry.icons)) {
  if (/\sstyle=/.test(icon)) delete SvgRegistry.icons[name];
}

/** A form in an element of the page. */
export interface ShownForm {
  /** Shows these answers; for a form that is only read. */
  show(answers: object): void;
  close(): void;
}

export interface FormEvents {
  /** Each change. */
  changed(answers: object): void;
  /** The participant has answered everything that is required; false = they may go on changing it. */
  completed(answers: object): void;
}

/** `answers`: those given before. Without `events` the form is only read. */
export async function showForm(
  element: HTMLElement,
  json: string,
  language: string,
  answers: object,
  events?: FormEvents,
): Promise<ShownForm> {
  // @ts-expect-error The package has no types for its translations.
  if (language !== "en") await import("survey-core/survey.i18n");
  settings.animationEnabled = false;
  const survey = new Model(JSON.parse(json));
  survey.locale = localeOf(language);
  survey.data = answers;
  survey.showCompletePage = false;
  survey.textUpdateMode = "onTyping"; // so that a draft has what is being typed
  survey.questionErrorLocation = "bottom";
  survey.focusFirstQuestionAutomatic = false;
  survey.readOnly = events === undefined;
  if (events === undefined) survey.questionsOnPageMode = "singlePage";
  else {
    goToFirstGap(survey);
    survey.onValueChanged.add(() => events.changed(survey.data));
    survey.onCompleting.add((_, options) => {
      options.allow = false; // it stays on the page until the service has it
      events.completed(survey.data);
    });
  }
  renderSurvey(survey, element);
  return {
    show: (newer) => {
      survey.data = newer;
    },
    close: () => {
      render(null, element);
      survey.dispose();
    },
  };
}

/** The form library's name of a language, of the nearest one that it has: "pt-BR" is "pt-br", "de-AT" "de", "zh" "zh-cn". */
function localeOf(language: string): string {
  const known = Object.keys(surveyLocalization.locales);
  const has = (start: string) => known.find((locale) => locale.toLowerCase().startsWith(start));
  const [root = ""] = language.toLowerCase().split("-");
  const exact = [language.toLowerCase(), root].find((name) => known.includes(name));
  return exact ?? has(`${root}-`) ?? language;
}

/** A form that was filled in half goes on at its first page with an empty question. */
function goToFirstGap(survey: Model): void {
  if (Object.keys(survey.data).length === 0) return;
  const isGap = (question: Question) => question.hasInput && question.isEmpty();
  const gap = survey.visiblePages.find((page) =>
    (page.questions as Question[]).some((question) => question.isVisible && isGap(question)),
  );
  survey.currentPage = gap ?? survey.visiblePages.at(-1);
}
